"""The order in which a recording is sent, by the player, by the world and into a bag alike."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from wsn_tracking.bags.messages import TruthPose
from wsn_tracking.sensing.recording import Message, Recording, Truth, epoch_key
from wsn_tracking.sensing.values import EpochEnd, Range, RangeBearing, Request, Rssi, TriggerReport

TOPICS: dict[type, str] = {
    Request: 'request',
    Rssi: 'rssi',
    Range: 'range',
    RangeBearing: 'observation',
    EpochEnd: 'epoch_end',
    TriggerReport: 'trigger_report',
}


class Event(NamedTuple):
    """One message to send."""

    stamp_ns: int
    epoch: int  # index of its epoch in the order of the requests
    topic: str
    value: Message | TruthPose


class Playback(NamedTuple):
    """A recording as a sequence of events."""

    events: tuple[Event, ...]
    epochs: tuple[tuple[int, int], ...]  # (target_id, request_seq) of each epoch, by index


def playback(recording: Recording) -> Playback:
    """All messages in the order of the log, truth ahead of the epochs that it judges.

    The truth of every target is sent up to its first sample at or after an epoch's stamp before that epoch is, so
    that whoever interpolates holds both neighbours in time. What lies beyond that of the last epoch judges nothing and
    is not sent.
    """
    truth = {target: deque(_poses(track)) for target, track in sorted(recording.truth.items())}
    told = dict.fromkeys(truth, -math.inf)  # stamp of the last sample that was sent
    epochs: list[tuple[int, int]] = []
    open_epochs: dict[tuple[int, int], int] = {}
    asked: set[int] = set()
    events: list[Event] = []
    for message in recording.messages:
        key = epoch_key(message)
        asks = isinstance(message, Request)
        if key not in open_epochs or (asks and open_epochs[key] in asked):  # a key that asks again: a new run
            open_epochs[key] = len(epochs)
            epochs.append(key)
        index = open_epochs[key]
        if asks:
            asked.add(index)
        for target, poses in truth.items():
            while poses and told[target] < message.stamp_ns:
                told[target] = poses[0].stamp_ns
                events.append(Event(message.stamp_ns, index, f'truth/target_{target}', poses.popleft()))
        events.append(Event(message.stamp_ns, index, TOPICS[type(message)], message))
    return Playback(tuple(events), tuple(epochs))


def _poses(truth: Truth) -> Iterator[TruthPose]:
    columns = (truth.stamps_ns.tolist(), truth.positions.tolist(), truth.velocities.tolist())
    for stamp, position, velocity in zip(*columns, strict=True):
        yield TruthPose(stamp, truth.target_id, tuple(position), tuple(velocity))
