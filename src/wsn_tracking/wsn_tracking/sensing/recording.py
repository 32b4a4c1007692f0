"""A bag in memory."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.values import EpochEnd, Measurement, Request, TriggerReport

Message = Request | Measurement | EpochEnd | TriggerReport


class Truth(NamedTuple):
    """Where a target really was, ascending in time."""

    target_id: int
    stamps_ns: NDArray[np.int64]  # (K,)
    positions: Floats  # (K, 3) [m], frame map
    velocities: Floats  # (K, 3) [m/s], frame map; NaN: not recorded
    headings: Floats | None = None  # (K,) [rad] where it faces; NaN: not recorded; None: nowhere


class Recording(NamedTuple):
    """What a bag holds for a tracker and for its judge.

    `entry_level` is the one level at which measurements enter: rssi, range or observation.
    `messages` are in the order of the log. `metadata` holds entry_level, and where known: area
    ("x_min y_min x_max y_max" [m]), target_height ([m]), period ([s]), configuration, scenario, seed, source.
    `dropped` counts what the reader could not use, by reason.
    """

    anchors: Anchors
    entry_level: str
    messages: tuple[Message, ...]
    truth: Mapping[int, Truth]
    metadata: Mapping[str, str]
    dropped: Mapping[str, int]


def epoch_key(message: Message) -> tuple[int, int]:
    """Target and number of the epoch that a message belongs to."""
    return message.target_id, message.seq if isinstance(message, Request) else message.request_seq


def of_target(recording: Recording, target_id: int) -> Recording:
    """What concerns one target; -1: all of it."""
    if target_id < 0:
        return recording
    return recording._replace(
        messages=tuple(m for m in recording.messages if m.target_id == target_id),
        truth={target: truth for target, truth in recording.truth.items() if target == target_id},
    )
