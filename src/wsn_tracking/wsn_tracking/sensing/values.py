"""What the radio says, as plain values: one NamedTuple a message, stamps in integer nanoseconds."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

NAN = float('nan')


class Modality(IntEnum):
    """How a range was measured (RangeMeasurement.MODALITY_*)."""

    UNKNOWN = 0
    RSSI = 1
    UWB = 2
    ULTRASOUND = 3
    OTHER = 4


class Reason(IntEnum):
    """Why a node stayed silent (TriggerReport.REASON_*)."""

    NOT_HEARD = 1
    OUT_OF_RADIUS = 2
    UNCHANGED = 3
    NOISY = 4
    NOT_DRAWN = 5
    INVALID = 6
    ON_BOARD = 7


class Request(NamedTuple):
    """A target asks to be located; opens epoch (target_id, seq)."""

    stamp_ns: int
    target_id: int
    seq: int


class Rssi(NamedTuple):
    """Signal strength [dBm] of one target's packet at one node."""

    stamp_ns: int
    node_id: int
    target_id: int
    seq: int
    request_seq: int
    rssi_dbm: float
    sigma_db: float = NAN
    n_samples: int = 1


class Range(NamedTuple):
    """Distance node - target [m], its variance [m^2], the signal strength beside it [dBm]; NaN = unknown."""

    stamp_ns: int
    node_id: int
    target_id: int
    seq: int
    request_seq: int
    modality: int
    range: float
    variance: float = NAN
    rssi_dbm: float = NAN
    n_samples: int = 1


class RangeBearing(NamedTuple):
    """Distance [m] and direction [rad] of a target seen from a node; NaN = not measured."""

    stamp_ns: int
    node_id: int
    target_id: int
    seq: int
    request_seq: int
    range: float
    bearing: float
    covariance: tuple[float, float, float, float]
    arrived: bool = True


class EpochEnd(NamedTuple):
    """Everything sent in one epoch on one topic, in sending order."""

    stamp_ns: int
    target_id: int
    request_seq: int
    topic: str
    node_ids: tuple[int, ...]
    seqs: tuple[int, ...]
    final: bool = False


class TriggerReport(NamedTuple):
    """Which nodes sent a range in an epoch (and its seq), which stayed silent, and why."""

    stamp_ns: int
    target_id: int
    request_seq: int
    sent_ids: tuple[int, ...]
    sent_seqs: tuple[int, ...]
    silent_ids: tuple[int, ...]
    reasons: tuple[int, ...]


Measurement = Rssi | Range | RangeBearing


class Epoch(NamedTuple):
    """All that is known of one target at one instant.

    `measurements` holds at most one value a node, ascending by node_id: several packets of a node
    within the epoch are averaged (n_samples says how many).
    """

    target_id: int
    request_seq: int
    stamp_ns: int
    measurements: tuple[Measurement, ...]
