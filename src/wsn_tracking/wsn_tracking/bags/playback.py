"""The order in which a recording is sent, by the player, by the world and into a bag alike."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.bags.messages import TruthPose
from wsn_tracking.sensing.recording import Message, Recording
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

    Truth is sent up to the first sample at or after an epoch's stamp before that epoch is, so that whoever
    interpolates holds both neighbours in time.
    """
    truth = _truth(recording)
    epochs: list[tuple[int, int]] = []
    open_epochs: dict[tuple[int, int], int] = {}
    asked: set[int] = set()
    events: list[Event] = []
    sent = 0
    for message in recording.messages:
        key = (message.target_id, message.seq if isinstance(message, Request) else message.request_seq)
        asks = isinstance(message, Request)
        if key not in open_epochs or (asks and open_epochs[key] in asked):  # a key that asks again: a new run
            open_epochs[key] = len(epochs)
            epochs.append(key)
        index = open_epochs[key]
        if asks:
            asked.add(index)
        while sent < len(truth) and (sent == 0 or truth[sent - 1].stamp_ns < message.stamp_ns):
            events.append(Event(message.stamp_ns, index, f'truth/target_{truth[sent].target_id}', truth[sent]))
            sent += 1
        events.append(Event(message.stamp_ns, index, TOPICS[type(message)], message))
    return Playback(tuple(events), tuple(epochs))


def _truth(recording: Recording) -> list[TruthPose]:
    poses = [
        TruthPose(stamp, truth.target_id, tuple(position), tuple(velocity))
        for truth in recording.truth.values()
        for stamp, position, velocity in zip(
            truth.stamps_ns.tolist(), truth.positions.tolist(), truth.velocities.tolist(), strict=True
        )
    ]
    return sorted(poses, key=lambda pose: pose.stamp_ns)
