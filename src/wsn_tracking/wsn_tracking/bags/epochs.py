"""Which messages of a bag form an epoch: the player and the evaluator both ask here."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Message, Recording, epoch_key
from wsn_tracking.sensing.values import (
    EpochEnd,
    Measurement,
    Range,
    RangeBearing,
    Request,
    Rssi,
    TriggerReport,
)

Key = tuple[int, int]  # target_id, request_seq: an epoch
Item = Measurement | TriggerReport
MEASUREMENTS = (Rssi, Range, RangeBearing)


def with_epoch_ends(recording: Recording, tolerance_s: float = 0.05) -> Recording:
    """The recording with an EpochEnd for every epoch, the last one of each target final.

    A bag that has EpochEnds for its entry level keeps its messages and their order; what an EpochEnd lists
    but the bag does not hold is taken from the list (`listed_missing`), and an epoch begun after the last
    EpochEnd is left out (`unfinished_epoch`): the recording was cut there. Else they are derived:

    - with requests: measurements belong to the request that they name, or, where there is none, to the
      nearest in time within the tolerance;
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
    tolerance_ns = round(tolerance_s * 1e9)
    rest = [m for m in messages if not isinstance(m, EpochEnd)]
    if any(isinstance(m, Request) for m in rest):
        assigned, lost = _by_request(rest, tolerance_ns)
    else:
        assigned, lost = _by_stamp(rest, tolerance_ns), 0
    ended = _with_ends(assigned, recording.entry_level)
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
            if epoch_key(message) not in ended and place > last.get(message.target_id, -1):
                dropped['unfinished_epoch'] += 1
            else:
                out.append(message)
        elif _level(message) != level:
            dropped['not_entry_level'] += 1
        else:
            listed = list(zip(message.node_ids, message.seqs, strict=False))
            kept = [entry for entry in listed if (*epoch_key(message), *entry) in held]
            dropped['listed_missing'] += max(len(message.node_ids), len(message.seqs)) - len(kept)
            out.append(_end(message, kept, level, place == last[message.target_id]))
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


def _end(like: EpochEnd, listed: Sequence[tuple[int, int]], level: str, final: bool) -> EpochEnd:
    nodes, seqs = tuple(node for node, _ in listed), tuple(seq for _, seq in listed)
    return like._replace(topic=level, node_ids=nodes, seqs=seqs, final=final)


def _by_request(messages: Sequence[Message], tolerance_ns: int) -> tuple[list[Message], int]:
    """Every message with the request it belongs to; and how many belong to none."""
    requests: dict[int, list[Request]] = defaultdict(list)
    for message in messages:
        if isinstance(message, Request):
            requests[message.target_id].append(message)
    for group in requests.values():
        group.sort(key=lambda request: request.stamp_ns)
    known = {epoch_key(request) for group in requests.values() for request in group}
    placed: list[Message] = []
    lost = 0
    for message in messages:
        if isinstance(message, (Request, EpochEnd)) or epoch_key(message) in known:
            placed.append(message)
            continue
        near = _nearest(requests[message.target_id], message.stamp_ns)
        if near is not None and abs(near.stamp_ns - message.stamp_ns) <= tolerance_ns:
            placed.append(message._replace(request_seq=near.seq))
        else:
            lost += 1
    return placed, lost


def _nearest(requests: Sequence[Request], stamp_ns: int) -> Request | None:
    """Of requests ascending in time, the nearest to an instant."""
    at = bisect_left(requests, stamp_ns, key=lambda request: request.stamp_ns)
    around = requests[max(at - 1, 0) : at + 1]
    return min(around, key=lambda request: abs(request.stamp_ns - stamp_ns), default=None)


def _by_stamp(messages: Iterable[Message], tolerance_ns: int) -> list[Message]:
    """Requests made from stamps, and every message with the number of the request made for it."""
    of_target: dict[int, list[Item]] = defaultdict(list)
    for message in messages:
        if not isinstance(message, (Request, EpochEnd)):
            of_target[message.target_id].append(message)
    epochs: list[tuple[Request, list[Item]]] = []
    for target_id, items in of_target.items():
        seq = -1
        for item in sorted(items, key=lambda m: m.stamp_ns):  # stable: the log's order where stamps are equal
            if seq < 0 or item.stamp_ns - epochs[-1][0].stamp_ns > tolerance_ns:
                seq += 1
                epochs.append((Request(item.stamp_ns, target_id, seq), []))
            epochs[-1][1].append(item._replace(request_seq=seq))
    epochs.sort(key=lambda epoch: epoch[0].stamp_ns)
    return [message for request, items in epochs for message in (request, *items)]


def _with_ends(messages: Sequence[Message], level: str) -> tuple[Message, ...]:
    """An EpochEnd after the last message of each epoch, those of a target in the order of its requests."""
    requests: dict[Key, Request] = {}
    closes: dict[Key, int] = {}
    listed: dict[Key, dict[tuple[int, int], None]] = defaultdict(dict)
    for place, message in enumerate(messages):
        key = epoch_key(message)
        closes[key] = place
        if isinstance(message, Request):
            requests.setdefault(key, message)
        elif isinstance(message, MEASUREMENTS):
            listed[key][message.node_id, message.seq] = None  # a repeated packet is listed once
    latest: dict[int, int] = {}
    final = {key[0]: key for key in requests}
    ends: dict[int, list[EpochEnd]] = defaultdict(list)
    for key, request in requests.items():
        latest[key[0]] = max(latest.get(key[0], -1), closes[key])
        empty = EpochEnd(request.stamp_ns, *key, level, (), ())
        ends[latest[key[0]]].append(_end(empty, list(listed[key]), level, final[key[0]] == key))
    return tuple(item for place, message in enumerate(messages) for item in (message, *ends[place]))
