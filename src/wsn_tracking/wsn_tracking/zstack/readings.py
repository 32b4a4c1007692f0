"""What the nodes measure of a robot's request, and the records in which they tell it.

Radios tell signal strengths in whole dB, and ranges in mm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.records import RangeRecord, RssiRecord

WORST_RSSI, BEST_RSSI = -127, 127
MAX_RANGE_MM = 0xFFFF


class Reading(NamedTuple):
    """What one node measured of one robot's request; None is what it did not."""

    node_id: int
    rssi_dbm: float | None = None
    range_m: float | None = None
    sigma: float | None = None  # [dB] or [m]
    n_samples: int = 1


class AirEpoch(NamedTuple):
    """One request of a robot, `time_s` after the first of all."""

    time_s: float
    robot_id: int
    request_seq: int
    readings: tuple[Reading, ...]


def rssi_record(reading: Reading, robot_id: int, age_ms: int, beacon: int) -> RssiRecord:
    """The record of a signal strength; radios tell whole dB."""
    if reading.rssi_dbm is None or math.isnan(reading.rssi_dbm):
        rssi = None
    else:
        rssi = min(max(math.floor(reading.rssi_dbm + 0.5), WORST_RSSI), BEST_RSSI)
    sigma = None if reading.sigma is None or math.isnan(reading.sigma) else min(max(reading.sigma, 0.0), 15.8)
    return RssiRecord(robot_id, age_ms, rssi, min(reading.n_samples, 255), sigma, beacon)


def range_record(reading: Reading, robot_id: int, age_ms: int, beacon: int) -> RangeRecord:
    """The record of a range, in mm."""
    if reading.range_m is None:
        raise TrackingError(f'traffic.payload range: node {reading.node_id} has measured none, choose rssi or auto')
    if not 0.0 <= reading.range_m <= MAX_RANGE_MM * 1e-3:
        raise TrackingError(
            f'node {reading.node_id} has measured a range of {reading.range_m} m: expected 0 to {MAX_RANGE_MM * 1e-3} m'
        )
    sigma = 0.0 if reading.sigma is None or math.isnan(reading.sigma) else reading.sigma
    return RangeRecord(robot_id, age_ms, round(reading.range_m * 1e3), min(round(sigma * 1e3), 255), beacon)
