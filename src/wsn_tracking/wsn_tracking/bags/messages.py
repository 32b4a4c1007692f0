"""Values to message bytes, and decoded columns back to values.

A value's fields carry the names of the message's fields (`stamp_ns` stands for the header), so that one rule
serves them all; only the truth, the anchors and the estimates need words of their own.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain, repeat
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError

from wsn_tracking.bags.types import BASE_TYPES, ESTIMATE, ODOMETRY, typestore
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.sensing.values import NAN, EpochEnd, Range, RangeBearing, Request, Rssi, TriggerReport
from wsn_tracking.trackers.estimate import Estimate

V = TypeVar('V', Request, Rssi, Range, RangeBearing, EpochEnd, TriggerReport)
Columns = Mapping[str, Any]  # dotted field name -> one entry a message

UNKNOWN = 1e6  # variance of an axis that says nothing [m^2, m^2/s^2, rad^2]
BLOCK = 4096  # messages that are made at once: their numbers stay in the processor's cache
EXACT = 1e-6  # variance of a truth [m^2]; never 0, which many readers take for `unknown`
PLAIN: Mapping[type[Any], str] = {
    Request: BASE_TYPES['request'],
    Rssi: BASE_TYPES['rssi'],
    Range: BASE_TYPES['range'],
    RangeBearing: BASE_TYPES['observation'],
    EpochEnd: BASE_TYPES['epoch_end'],
    TriggerReport: BASE_TYPES['trigger_report'],
}


class TruthPose(NamedTuple):
    """Where a target really is at one instant; a velocity of NaN is not known."""

    stamp_ns: int
    target_id: int
    position: tuple[float, float, float]  # [m], frame map
    velocity: tuple[float, float, float] = (NAN, NAN, NAN)  # [m/s], frame map


def type_of(value: object) -> str:
    """Message type that carries a value."""
    special: Mapping[type[Any], str] = {
        TruthPose: ODOMETRY,
        Anchors: BASE_TYPES['anchors'],
        Estimate: ESTIMATE,
    }
    name = PLAIN.get(type(value)) or special.get(type(value))
    if name is None:
        raise TrackingError(f'{type(value).__name__} is no value that a bag holds')
    return name


def to_cdr(value: object, log_ns: int) -> bytes:
    """Serialise a value, zero padding. `log_ns` is the stamp of a value that has none (the anchors)."""
    name = type_of(value)
    fields = _fields_of(value)
    try:
        header = _header(getattr(value, 'stamp_ns', log_ns))
        message = _build(name, {'header': header, **fields})
        return bytes(typestore().serialize_cdr(message, name))
    except (struct.error, SerdeError, ValueError, TypeError, OverflowError, AttributeError) as error:
        shown = ' '.join(repr(value).split())
        raise TrackingError(f'{shown[:160]} does not fit into {name}: {error}') from error


def _fields_of(value: Any) -> dict[str, Any]:
    if isinstance(value, TruthPose):
        return _odometry(value)
    if isinstance(value, Anchors):
        x, y, z = value.positions.T
        return {'x': x, 'y': y, 'z': z} | {k: v for k, v in value._asdict().items() if k != 'positions'}
    return {k: v for k, v in value._asdict().items() if k != 'stamp_ns'}


def _header(stamp_ns: int) -> Any:
    sec, nanosec = divmod(int(stamp_ns), 1_000_000_000)
    return _build('std_msgs/msg/Header', {'stamp': {'sec': sec, 'nanosec': nanosec}, 'frame_id': 'map'})


def _odometry(pose: TruthPose) -> dict[str, Any]:
    known = all(np.isfinite(pose.velocity))
    linear = pose.velocity if known else (0.0, 0.0, 0.0)
    return {
        'child_frame_id': f'target_{pose.target_id}',
        'pose': {
            'pose': {
                'position': dict(zip('xyz', pose.position, strict=True)),
                'orientation': {'x': 0.0, 'y': 0.0, 'z': 0.0, 'w': 1.0},
            },
            'covariance': np.diag([EXACT] * 3 + [UNKNOWN] * 3),
        },
        'twist': {
            'twist': {
                'linear': dict(zip('xyz', linear, strict=True)),
                'angular': {'x': 0.0, 'y': 0.0, 'z': 0.0},
            },
            'covariance': np.diag([EXACT if known else UNKNOWN] * 3 + [UNKNOWN] * 3),
        },
    }


def _build(name: str, fields: Mapping[str, Any]) -> Any:
    """A message object of rosbags from nested plain values, every number checked against its type."""
    arguments = {}
    for field, (kind, detail) in typestore().fielddefs[name][1]:
        value = fields[field]
        if kind == Nodetype.NAME and isinstance(value, Mapping):
            value = _build(cast(str, detail), value)
        elif kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            value = _sequence(field, detail[0][1][0], value)
        elif kind == Nodetype.BASE and detail[0] not in ('string', 'bool', 'float64', 'float32'):
            value = int(value)
        arguments[field] = value
    return typestore().types[name](**arguments)


def _sequence(field: str, base: str, value: Any) -> Any:
    if base == 'string':
        return [str(text) for text in value]
    wide = np.asarray(value).reshape(-1)
    if wide.size == 0:
        return np.zeros(0, dtype=base)
    if base.startswith('float'):
        return wide.astype(base)
    limits = np.iinfo(base)
    if wide.min() < limits.min or wide.max() > limits.max:
        raise ValueError(f'`{field}` holds {wide.min()}..{wide.max()}, {base} holds {limits.min}..{limits.max}')
    return wide.astype(base)


def stamps_ns(columns: Columns) -> NDArray[np.int64]:
    """Header stamps of decoded messages, (K,) [ns]."""
    sec = np.asarray(columns['header.stamp.sec'], dtype=np.int64)
    return sec * 1_000_000_000 + np.asarray(columns['header.stamp.nanosec'], dtype=np.int64)


def plain_values(kind: type[V], columns: Columns) -> Iterable[V]:
    """One value of a class in PLAIN for each decoded message, in their order."""
    names: Sequence[str] = kind._fields[1:]
    table = [stamps_ns(columns), *(columns[name] for name in names)]

    def block(start: int) -> Iterable[V]:
        rows = zip(*(_cells(column[start : start + BLOCK]) for column in table), strict=True)
        # tuple.__new__ skips the count of the fields, half the time of `kind(...)`; zip has taken one of each
        return map(tuple.__new__, repeat(kind), rows)

    return chain.from_iterable(map(block, range(0, len(table[0]), BLOCK)))


def _cells(column: Any) -> Iterable[Any]:
    """Python objects of a column: numbers, tuples or texts."""
    if isinstance(column, np.ndarray):
        return column.tolist() if column.ndim == 1 else map(tuple, column.tolist())
    return cast('Iterable[Any]', column)


def anchors_of(columns: Columns) -> Anchors:
    """The last of the decoded tables of anchors."""
    last = {name: np.asarray(columns[name][-1]) for name in ('x', 'y', 'z', *Anchors._fields) if name in columns}
    sizes = {name: column.size for name, column in last.items()}
    if len(set(sizes.values())) != 1:
        raise TrackingError(f'the anchors have columns of different length {sizes}: one entry a node is expected')
    radio = {k: last[k] for k in ('p1_dbm', 'd0', 'n', 'sigma_db', 'bias', 'scale')}
    return make_anchors(last['ids'], np.column_stack([last['x'], last['y'], last['z']]), **radio)


def truth_of(target_id: int, columns: Columns) -> tuple[Truth, int]:
    """The decoded Odometry as one ascending track, and how many messages could not be part of it.

    The twist is turned from the child frame into the frame of the pose (REP-105); a velocity or a yaw whose variance
    is UNKNOWN or more becomes NaN.
    """
    stamps = stamps_ns(columns)
    position = _vectors(columns, 'pose.pose.position', 'xyz')
    linear = _vectors(columns, 'twist.twist.linear', 'xyz')
    quaternion = _vectors(columns, 'pose.pose.orientation', 'xyzw')
    variance = np.asarray(columns['twist.covariance'], dtype=np.float64).reshape(-1, 6, 6)[:, range(3), range(3)]
    velocity = np.where(variance < UNKNOWN, _turn(quaternion, linear), np.nan)
    yaw_variance = np.asarray(columns['pose.covariance'], dtype=np.float64).reshape(-1, 36)[:, -1]
    upright = (quaternion[:, :3] == 0.0).all(axis=1) & (yaw_variance == 0.0)  # of those who set neither
    heading = np.where((yaw_variance < UNKNOWN) & ~upright, _yaw(quaternion), np.nan)
    usable = np.flatnonzero(np.all(np.isfinite(position), axis=1))
    stamps, first = np.unique(stamps[usable], return_index=True)
    rows = usable[first]
    told = heading[rows] if np.isfinite(heading[rows]).any() else None
    return Truth(target_id, stamps, position[rows], velocity[rows], told), position.shape[0] - rows.size


def _vectors(columns: Columns, prefix: str, axes: str) -> Floats:
    return np.column_stack([np.asarray(columns[f'{prefix}.{axis}'], dtype=np.float64) for axis in axes])


def _turn(quaternion: Floats, vector: Floats) -> Floats:
    """Rotate (K, 3) vectors by (K, 4) quaternions x y z w; an unusable quaternion turns nothing."""
    with np.errstate(all='ignore'):
        norm = np.linalg.norm(quaternion, axis=1, keepdims=True)
        good = np.isfinite(norm) & (norm > 1e-9)
        unit = np.where(good, quaternion / norm, [0.0, 0.0, 0.0, 1.0])
        axis, w = unit[:, :3], unit[:, 3:]
        half = 2.0 * np.cross(axis, vector)
        return np.asarray(vector + w * half + np.cross(axis, half), dtype=np.float64)


def _yaw(quaternion: Floats) -> Floats:
    """Direction (K,) [rad] of the x axis in the plane, of (K, 4) quaternions x y z w; NaN: unusable."""
    x, y, z, w = quaternion.T
    with np.errstate(invalid='ignore'):
        norm = np.sqrt(x * x + y * y + z * z + w * w)
        return np.where(norm > 1e-9, np.arctan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z), np.nan)


def estimates_of(columns: Columns) -> list[Estimate]:
    """TargetEstimate messages as values."""
    stamps = stamps_ns(columns).tolist()
    names = [name for name in Estimate._fields if name not in ('stamp_ns', 'mean', 'covariance')]
    cells = {name: list(_cells(columns[name])) for name in names}
    values = []
    for k, stamp in enumerate(stamps):
        mean = np.asarray(columns['mean'][k], dtype=np.float64)
        covariance = np.asarray(columns['covariance'][k], dtype=np.float64)
        if covariance.size != mean.size**2:
            raise TrackingError(
                f'an estimate has {mean.size} states and {covariance.size} entries of covariance, '
                f'expected {mean.size**2}'
            )
        rest = {name: cells[name][k] for name in names}
        rest.update({name: tuple(rest[name]) for name in ('contributors', 'measurements', 'state_names')})
        matrix = covariance.reshape(mean.size, mean.size)
        values.append(Estimate(stamp_ns=stamp, mean=mean, covariance=matrix, **rest))
    return values
