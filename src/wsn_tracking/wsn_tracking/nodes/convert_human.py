"""HumanReport message <-> value; a message that cannot be a value raises TrackingError."""

from __future__ import annotations

from wsn_tracking_msgs import msg

from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes.convert import header, stamp_ns
from wsn_tracking.trackers.human_report import HumanReport


def report_value(m: msg.HumanReport) -> HumanReport:
    """The value of a HumanReport."""
    if len(m.node_ids) != len(m.node_log_evidences):
        raise TrackingError(
            f'a HumanReport has {len(m.node_ids)} nodes and {len(m.node_log_evidences)} evidences: expected as many'
        )
    fields = {name: getattr(m, name) for name in HumanReport._fields if name != 'stamp_ns'}
    fields |= {name: tuple(fields[name].tolist()) for name in ('node_ids', 'node_log_evidences')}
    return HumanReport(stamp_ns(m.header.stamp), **fields)


def report_message(r: HumanReport) -> msg.HumanReport:
    """The message of a HumanReport."""
    fields = r._asdict()
    return msg.HumanReport(header=header(fields.pop('stamp_ns')), **fields)
