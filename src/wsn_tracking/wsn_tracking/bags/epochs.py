"""Which messages of a bag form an epoch: the player and the evaluator both ask here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from wsn_tracking.bags.derived import MEASUREMENTS, derived, end_of
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Message, Recording, epoch_key
from wsn_tracking.sensing.values import EpochEnd, Request


def with_epoch_ends(recording: Recording, tolerance_s: float = 0.05) -> Recording:
    """The recording with an EpochEnd for every epoch, the last one of each target final.

    A bag that has EpochEnds for its entry level keeps its messages and their order; what an EpochEnd lists
    but the bag does not hold is taken from the list (`listed_missing`), and an epoch without one is left out
    (`unfinished_epoch`): the recording was cut there, or is damaged. Else they are derived:

    - with requests: measurements belong to the request that they name (to the nearest in time, where a restarted
      target has used its number again), or, where there is none, to the nearest in time within the tolerance;
    - without: in the order of the stamps, packets of a target within the tolerance of an epoch's first
      are that epoch; its Request gets that stamp and the next number, the measurements that number.

    What belongs to no epoch is left out and counted (`no_epoch`). The end comes right after the last
    message of its epoch. Raises TrackingError for a tolerance that is not positive and finite.
    """
    if not 0.0 < tolerance_s < 1e6:
        raise TrackingError(f'tolerance {tolerance_s} s: a positive time is expected, 0.05 s by default')
    messages = recording.messages
    if any(isinstance(m, EpochEnd) and _level(m) == recording.entry_level for m in messages):
        return _completed(recording)
    ended, lost = derived(messages, recording.entry_level, round(tolerance_s * 1e9))
    return recording._replace(messages=ended, dropped=_counted(recording.dropped, {'no_epoch': lost}))


def _level(end: EpochEnd) -> str:
    return end.topic.rpartition('/')[2]


def _counted(dropped: Mapping[str, int], more: Mapping[str, int]) -> dict[str, int]:
    total = Counter(dropped)
    total.update(more)
    return {reason: count for reason, count in total.items() if count}


def _completed(recording: Recording) -> Recording:
    """A bag with EpochEnds: only ends of its level, lists that hold, and one final a target."""
    level, messages = recording.entry_level, recording.messages
    held = {(*epoch_key(m), m.node_id, m.seq) for m in messages if isinstance(m, MEASUREMENTS)}
    last = {m.target_id: i for i, m in enumerate(messages) if isinstance(m, EpochEnd) and _level(m) == level}
    ended = {epoch_key(m) for m in messages if isinstance(m, EpochEnd) and _level(m) == level}
    out: list[Message] = []
    dropped = {'listed_missing': 0, 'unfinished_epoch': 0, 'not_entry_level': 0}
    for place, message in enumerate(messages):
        if not isinstance(message, EpochEnd):
            if epoch_key(message) in ended:
                out.append(message)
            else:
                dropped['unfinished_epoch'] += 1
        elif _level(message) != level:
            dropped['not_entry_level'] += 1
        else:
            listed = list(zip(message.node_ids, message.seqs, strict=False))
            kept = [entry for entry in listed if (*epoch_key(message), *entry) in held]
            dropped['listed_missing'] += max(len(message.node_ids), len(message.seqs)) - len(kept)
            out.append(end_of(message, kept, level, place == last[message.target_id]))
    whole, dropped['request_rebuilt'] = _with_requests(out)
    return recording._replace(messages=whole, dropped=_counted(recording.dropped, dropped))


def _with_requests(messages: Sequence[Message]) -> tuple[tuple[Message, ...], int]:
    """The messages with a Request, of its EpochEnd's stamp, ahead of each epoch that lacks one; and how many do."""
    asked = {epoch_key(m) for m in messages if isinstance(m, Request)}
    stamps = {epoch_key(m): m.stamp_ns for m in messages if isinstance(m, EpochEnd)}
    out: list[Message] = []
    rebuilt = 0
    for message in messages:
        key = epoch_key(message)
        if key not in asked and key in stamps:
            asked.add(key)
            rebuilt += 1
            out.append(Request(stamps[key], *key))
        out.append(message)
    return tuple(out), rebuilt
