"""ROS messages <-> the package's values; a message that cannot be a value raises TrackingError."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.msg import Odometry
from std_msgs.msg import Header
from wsn_tracking_msgs import msg

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, check, make_anchors
from wsn_tracking.sensing.values import EpochEnd, Range, RangeBearing, Request, Rssi, TriggerReport
from wsn_tracking.trackers.consensus_share import Share
from wsn_tracking.trackers.estimate import Estimate, check_usable

FRAME = 'map'
UNKNOWN = 1e6  # variance of what is not estimated; never 0, which would claim certainty


def stamp_ns(time: Time) -> int:
    """Integer nanoseconds of a stamp."""
    return int(time.sec) * 1_000_000_000 + int(time.nanosec)


def header(ns: int) -> Header:
    """Header in frame map at integer nanoseconds."""
    return Header(stamp=Time(sec=ns // 1_000_000_000, nanosec=ns % 1_000_000_000), frame_id=FRAME)


def request_value(m: msg.LocationRequest) -> Request:
    """The value of a LocationRequest."""
    return Request(stamp_ns(m.header.stamp), m.target_id, m.seq)


def request_message(r: Request) -> msg.LocationRequest:
    """The message of a Request."""
    return msg.LocationRequest(header=header(r.stamp_ns), target_id=r.target_id, seq=r.seq)


def rssi_value(m: msg.RssiMeasurement) -> Rssi:
    """The value of an RssiMeasurement."""
    return Rssi(
        stamp_ns(m.header.stamp),
        m.node_id,
        m.target_id,
        m.seq,
        m.request_seq,
        m.rssi_dbm,
        m.sigma_db,
        max(m.n_samples, 1),
    )


def rssi_message(r: Rssi) -> msg.RssiMeasurement:
    """The message of an Rssi."""
    return msg.RssiMeasurement(header=header(r.stamp_ns), **_fields(r))


def range_value(m: msg.RangeMeasurement) -> Range:
    """The value of a RangeMeasurement."""
    return Range(
        stamp_ns(m.header.stamp),
        m.node_id,
        m.target_id,
        m.seq,
        m.request_seq,
        m.modality,
        m.range,
        m.variance,
        m.rssi_dbm,
        max(m.n_samples, 1),
    )


def range_message(r: Range) -> msg.RangeMeasurement:
    """The message of a Range."""
    return msg.RangeMeasurement(header=header(r.stamp_ns), **{**_fields(r), 'modality': int(r.modality)})


def range_bearing_value(m: msg.RangeBearing) -> RangeBearing:
    """The value of a RangeBearing."""
    a, b, c, d = m.covariance.tolist()
    return RangeBearing(
        stamp_ns(m.header.stamp),
        m.node_id,
        m.target_id,
        m.seq,
        m.request_seq,
        m.range,
        m.bearing,
        (a, b, c, d),
        m.arrived,
    )


def range_bearing_message(r: RangeBearing) -> msg.RangeBearing:
    """The message of a RangeBearing."""
    return msg.RangeBearing(header=header(r.stamp_ns), **_fields(r))


def epoch_end_value(m: msg.EpochEnd) -> EpochEnd:
    """The value of an EpochEnd."""
    if len(m.node_ids) != len(m.seqs):
        raise TrackingError(f'an EpochEnd lists {len(m.node_ids)} nodes and {len(m.seqs)} seqs: expected as many')
    return EpochEnd(
        stamp_ns(m.header.stamp),
        m.target_id,
        m.request_seq,
        m.topic,
        tuple(m.node_ids.tolist()),
        tuple(m.seqs.tolist()),
        m.final,
    )


def epoch_end_message(e: EpochEnd) -> msg.EpochEnd:
    """The message of an EpochEnd."""
    return msg.EpochEnd(header=header(e.stamp_ns), **_fields(e))


def report_value(m: msg.TriggerReport) -> TriggerReport:
    """The value of a TriggerReport."""
    if len(m.sent_ids) != len(m.sent_seqs) or len(m.silent_ids) != len(m.reasons):
        raise TrackingError(
            f'a TriggerReport has lists of {len(m.sent_ids)}, {len(m.sent_seqs)} and of {len(m.silent_ids)}, '
            f'{len(m.reasons)}: expected pairs of the same length'
        )
    return TriggerReport(
        stamp_ns(m.header.stamp),
        m.target_id,
        m.request_seq,
        tuple(m.sent_ids.tolist()),
        tuple(m.sent_seqs.tolist()),
        tuple(m.silent_ids.tolist()),
        tuple(m.reasons) if isinstance(m.reasons, bytes) else tuple(m.reasons.tolist()),
    )


def report_message(r: TriggerReport) -> msg.TriggerReport:
    """The message of a TriggerReport."""
    return msg.TriggerReport(header=header(r.stamp_ns), **_fields(r))


def share_value(m: msg.ConsensusShare) -> Share:
    """The value of a ConsensusShare; its numbers are checked by whoever takes it."""
    return Share(
        stamp_ns(m.header.stamp),
        m.target_id,
        m.request_seq,
        m.round,
        m.node_id,
        m.scheme,
        m.degree,
        bytes(m.live),
        tuple(m.information_vector),
        tuple(m.information),
        tuple(m.item_ids),
        tuple(m.items),
    )


def share_message(s: Share) -> msg.ConsensusShare:
    """The message of a Share; arrays go in as such, since lists would be checked number by number."""
    m = msg.ConsensusShare(header=header(s.stamp_ns))
    m.target_id, m.request_seq, m.round = s.target_id, s.request_seq, s.round
    m.node_id, m.scheme, m.degree = s.node_id, s.scheme, s.degree
    m.live = array('B', s.live)
    m.information_vector, m.information = array('d', s.information_vector), array('d', s.information)
    m.item_ids, m.items = array('H', s.item_ids), array('d', s.items)
    return m


def anchors_value(m: msg.Anchors) -> Anchors:
    """The table of an Anchors message."""
    columns = ('x', 'y', 'z', 'p1_dbm', 'd0', 'n', 'sigma_db', 'bias', 'scale')
    lengths = {name: len(getattr(m, name)) for name in columns}
    if set(lengths.values()) != {len(m.ids)}:
        raise TrackingError(f'Anchors hold {len(m.ids)} ids and columns of {lengths}: expected as many everywhere')
    positions = np.column_stack([np.asarray(m.x), np.asarray(m.y), np.asarray(m.z)])
    return make_anchors(m.ids, positions, **{name: np.asarray(getattr(m, name)) for name in columns[3:]})


def anchors_message(a: Anchors, ns: int) -> msg.Anchors:
    """The message of a table, stamped with the start of what it belongs to."""
    check(a)
    radio = {name: getattr(a, name).tolist() for name in ('p1_dbm', 'd0', 'n', 'sigma_db', 'bias', 'scale')}
    x, y, z = a.positions.T.tolist()
    return msg.Anchors(header=header(ns), ids=a.ids.tolist(), x=x, y=y, z=z, **radio)


def estimate_value(m: msg.TargetEstimate) -> Estimate:
    """The value of a TargetEstimate; its numbers are checked where they are used."""
    n = len(m.mean)
    if len(m.covariance) != n * n or len(m.state_names) != n or n == 0:
        raise TrackingError(
            f'an estimate of {m.source!r} has {n} means, {len(m.state_names)} names and {len(m.covariance)} '
            f'covariance entries: expected n, n and n^2'
        )
    return Estimate(
        stamp_ns(m.header.stamp),
        m.target_id,
        m.request_seq,
        m.source,
        np.array(m.mean),
        np.array(m.covariance).reshape(n, n),
        tuple(m.contributors.tolist()),
        tuple(m.measurements.tolist()),
        m.q,
        m.kind,
        tuple(m.state_names),
    )


def peer_value(m: msg.TargetEstimate) -> Estimate:
    """The value of a peer's TargetEstimate; one that no fusion may use is refused."""
    return check_usable(estimate_value(m))


def estimate_message(e: Estimate) -> msg.TargetEstimate:
    """The message of an Estimate."""
    return msg.TargetEstimate(
        header=header(e.stamp_ns),
        target_id=e.target_id,
        request_seq=e.request_seq,
        source=e.source,
        state_names=list(e.state_names),
        mean=e.mean.tolist(),
        covariance=e.covariance.ravel().tolist(),
        contributors=list(e.contributors),
        measurements=list(e.measurements),
        q=e.q,
        kind=int(e.kind),
    )


def odometry_message(e: Estimate, height: float) -> Odometry:
    """Position and velocity of a planar estimate as Odometry in frame map.

    The child frame's axes are parallel to map: the orientation is the identity with a large yaw variance,
    so the twist needs no rotation. What is not known has variance 1e6.
    """
    m = Odometry(header=header(e.stamp_ns), child_frame_id=f'target_{e.target_id}')
    m.pose.pose.position.x, m.pose.pose.position.y = float(e.mean[0]), float(e.mean[1])
    m.pose.pose.position.z = height
    m.pose.pose.orientation.w = 1.0
    m.twist.twist.linear.x, m.twist.twist.linear.y = float(e.mean[2]), float(e.mean[3])
    P = np.where(np.isnan(e.covariance), np.diag(np.full(len(e.mean), UNKNOWN)), e.covariance)
    m.pose.covariance = _planar(P[:2, :2])
    m.twist.covariance = _planar(P[2:4, 2:4])
    return m


def truth_position(m: Odometry) -> tuple[int, Floats, Floats]:
    """Stamp [ns], position (3,) and velocity (3,) of a truth Odometry."""
    p, v = m.pose.pose.position, m.twist.twist.linear
    return stamp_ns(m.header.stamp), np.array([p.x, p.y, p.z]), np.array([v.x, v.y, v.z])


def truth_message(target_id: int, ns: int, state: Floats, height: float) -> Odometry:
    """Truth Odometry of a planar state [x, y, vx, vy]; it is exact where it speaks."""
    m = Odometry(header=header(ns), child_frame_id=f'target_{target_id}')
    m.pose.pose.position.x, m.pose.pose.position.y = float(state[0]), float(state[1])
    m.pose.pose.position.z = height
    m.pose.pose.orientation.w = 1.0
    m.twist.twist.linear.x, m.twist.twist.linear.y = float(state[2]), float(state[3])
    m.pose.covariance = m.twist.covariance = _planar(np.zeros((2, 2)))
    return m


def _planar(P: Floats) -> Floats:
    """A 6x6 row-major covariance with the planar block given and the rest unknown."""
    full = np.diag(np.full(6, UNKNOWN))
    full[:2, :2] = P
    return full.ravel()


def _fields(value: Any) -> dict[str, Any]:
    fields = dict(value._asdict())
    del fields['stamp_ns']
    return {k: list(v) if isinstance(v, tuple) else v for k, v in fields.items()}
