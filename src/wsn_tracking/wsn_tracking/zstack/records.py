"""The records of 8 bytes in a payload (zstack.md, section 6). What the wire calls invalid or unknown is None here."""

from __future__ import annotations

import struct
from typing import NamedTuple

AGE_OLDER = 0xFFFF
RSSI_INVALID = -128
SIGMA_UNKNOWN = 255
SIGMA_UNITS = 16  # a dB
SPEED_M_S = 0.02  # per unit
CENTI = 100  # cm a m, cdB a dB


class RssiRecord(NamedTuple):
    """Signal strength of one robot's request at the node (or, on a person, of one reference node)."""

    robot_id: int
    age_ms: int | None  # measurement to sending [ms]; None: 65.5 s or older
    rssi_dbm: int | None
    n_samples: int = 1
    sigma_db: float | None = None  # in steps of 1/16 dB
    beacon_seq: int | None = None  # number of the request modulo 256; None only in reports that came as text


class RangeRecord(NamedTuple):
    """Distance of one robot."""

    robot_id: int
    age_ms: int | None
    range_mm: int
    sigma_mm: int
    beacon_seq: int | None


class FeedbackRecord(NamedTuple):
    """Where the host sees a robot: position [m] in steps of 1 cm, velocity [m/s] in steps of 2 cm/s."""

    robot_id: int
    x: float
    y: float
    vx: float
    vy: float


class SensingRecord(NamedTuple):
    """Measure or rest, and the thresholds of the on-board trigger: y_min [dBm], e_min and e_max [dB], steps of 0.01."""

    node_id: int
    active: int
    y_min: int
    e_min: float
    e_max: float


Record = RssiRecord | RangeRecord | FeedbackRecord | SensingRecord

RSSI = struct.Struct('<HHbBBB')
RANGE = struct.Struct('<HHHBB')
FEEDBACK = struct.Struct('<Hhhbb')
SENSING = struct.Struct('<HBbBBH')
# by type of the payload; heartbeats have no records
FORMATS = {1: RSSI, 2: RSSI, 3: RANGE, 4: RSSI, 5: FEEDBACK, 6: SENSING}


def unpack_record(kind: int, data: bytes, at: int) -> Record:
    """The record of a payload of type `kind` at that place."""
    fields = FORMATS[kind].unpack_from(data, at)
    if kind == 3:
        robot_id, age, range_mm, sigma_mm, beacon = fields
        return RangeRecord(robot_id, None if age == AGE_OLDER else age, range_mm, sigma_mm, beacon)
    if kind == 5:
        robot_id, x, y, vx, vy = fields
        return FeedbackRecord(robot_id, x / CENTI, y / CENTI, vx * SPEED_M_S, vy * SPEED_M_S)
    if kind == 6:
        node_id, active, y_min, e_min, e_max, _ = fields
        return SensingRecord(node_id, active, y_min, e_min / CENTI, e_max / CENTI)
    robot_id, age, rssi, n, sigma, beacon = fields
    return RssiRecord(
        robot_id,
        None if age == AGE_OLDER else age,
        None if rssi == RSSI_INVALID else rssi,
        n,
        None if sigma == SIGMA_UNKNOWN else sigma / SIGMA_UNITS,
        beacon,
    )


def pack_record(kind: int, record: Record) -> bytes:
    """The bytes of a record; struct.error or ValueError where a value does not fit or the record is of another type."""
    if isinstance(record, RssiRecord) and kind in (1, 4):
        return RSSI.pack(
            record.robot_id,
            AGE_OLDER if record.age_ms is None else record.age_ms,
            RSSI_INVALID if record.rssi_dbm is None else record.rssi_dbm,
            record.n_samples,
            SIGMA_UNKNOWN if record.sigma_db is None else round(record.sigma_db * SIGMA_UNITS),
            record.beacon_seq or 0,
        )
    if isinstance(record, RangeRecord) and kind == 3:
        age = AGE_OLDER if record.age_ms is None else record.age_ms
        return RANGE.pack(record.robot_id, age, record.range_mm, record.sigma_mm, record.beacon_seq or 0)
    if isinstance(record, FeedbackRecord) and kind == 5:
        x, y = round(record.x * CENTI), round(record.y * CENTI)
        return FEEDBACK.pack(record.robot_id, x, y, round(record.vx / SPEED_M_S), round(record.vy / SPEED_M_S))
    if isinstance(record, SensingRecord) and kind == 6:
        e_min, e_max = round(record.e_min * CENTI), round(record.e_max * CENTI)
        return SENSING.pack(record.node_id, record.active, record.y_min, e_min, e_max, 0)
    raise ValueError(f'a {type(record).__name__} in a payload of type {kind}')
