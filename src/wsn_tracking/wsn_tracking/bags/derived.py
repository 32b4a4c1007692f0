"""Epochs of a bag that has no EpochEnds: which messages form one, by requests or by stamps alone."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from wsn_tracking.sensing.recording import Message, epoch_key
from wsn_tracking.sensing.runs import JUMP_NS
from wsn_tracking.sensing.values import EpochEnd, Measurement, Range, RangeBearing, Request, Rssi, TriggerReport

Key = tuple[int, int]  # target_id, request_seq
Item = Measurement | TriggerReport
Placed = tuple[Message, int]  # with the number of its epoch in the recording
MEASUREMENTS = (Rssi, Range, RangeBearing)


class Asked(NamedTuple):
    """A request that opens an epoch."""

    number: int
    place: int  # in the log
    request: Request


def derived(messages: Iterable[Message], level: str, tolerance_ns: int) -> tuple[tuple[Message, ...], int]:
    """The messages with an EpochEnd for every epoch (see `with_epoch_ends`), and how many belong to none."""
    rest = [m for m in messages if not isinstance(m, EpochEnd)]
    asks = any(isinstance(m, Request) for m in rest)
    placed = _by_request(rest, tolerance_ns) if asks else _by_stamp(rest, tolerance_ns)
    return _with_ends(placed, level), len(rest) - len(placed) if asks else 0


def end_of(like: EpochEnd, listed: Sequence[tuple[int, int]], level: str, final: bool) -> EpochEnd:
    """An EpochEnd that lists these (node_id, seq)."""
    nodes, seqs = tuple(node for node, _ in listed), tuple(seq for _, seq in listed)
    return like._replace(topic=level, node_ids=nodes, seqs=seqs, final=final)


def _by_request(messages: Sequence[Message], tolerance_ns: int) -> list[Placed]:
    """Every message that belongs to a request."""
    asked = _asked(messages, tolerance_ns)
    of_key: dict[Key, list[Asked]] = defaultdict(list)
    of_target: dict[int, list[Asked]] = defaultdict(list)
    for epoch in asked:
        of_key[epoch_key(epoch.request)].append(epoch)
        of_target[epoch.request.target_id].append(epoch)
    for group in of_target.values():
        group.sort(key=_stamp)
    placed: list[Placed] = []
    for place, message in enumerate(messages):
        named = of_key.get(epoch_key(message), ())
        if named:
            placed.append((message, _of_several(named, message, place).number))
        elif (near := _nearest(of_target[message.target_id], message.stamp_ns, tolerance_ns)) is not None:
            placed.append((message._replace(request_seq=near.request.seq), near.number))  # type: ignore[call-arg]
    return placed


def _asked(messages: Sequence[Message], tolerance_ns: int) -> list[Asked]:
    """The requests that open an epoch each.

    A target that was restarted asks with its old numbers at another time, a looped bag with old numbers and old stamps:
    these are new epochs. The same number within the tolerance, with no fall of the stamps between, is the same request.
    """
    asked: list[Asked] = []
    newest: dict[int, int] = {}  # of each target, stamp since it fell last
    falls: Counter[int] = Counter()
    last: dict[Key, tuple[int, int]] = {}  # falls and stamp when a number was asked with last
    for place, message in enumerate(messages):
        if not isinstance(message, Request):
            continue
        target, stamp = message.target_id, message.stamp_ns
        if stamp < newest.get(target, stamp) - JUMP_NS:
            falls[target] += 1
            newest[target] = stamp
        newest[target] = max(newest.get(target, stamp), stamp)
        before = last.get(epoch_key(message))
        if before is None or before[0] != falls[target] or abs(before[1] - stamp) > tolerance_ns:
            asked.append(Asked(len(asked), place, message))
        last[epoch_key(message)] = falls[target], stamp
    return asked


def _of_several(named: Sequence[Asked], message: Message, place: int) -> Asked:
    """Of requests with the number of a message, the nearest to it in time, then in the log."""
    if len(named) == 1:
        return named[0]
    return min(named, key=lambda epoch: (abs(_stamp(epoch) - message.stamp_ns), abs(epoch.place - place)))


def _nearest(asked: Sequence[Asked], stamp_ns: int, tolerance_ns: int) -> Asked | None:
    """Of requests ascending in time, the nearest to an instant within the tolerance."""
    at = bisect_left(asked, stamp_ns, key=_stamp)
    around = [epoch for epoch in asked[max(at - 1, 0) : at + 1] if abs(_stamp(epoch) - stamp_ns) <= tolerance_ns]
    return min(around, key=lambda epoch: abs(_stamp(epoch) - stamp_ns), default=None)


def _stamp(epoch: Asked) -> int:
    return epoch.request.stamp_ns


def _by_stamp(messages: Iterable[Message], tolerance_ns: int) -> list[Placed]:
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
    return [(message, k) for k, (request, items) in enumerate(epochs) for message in (request, *items)]


def _with_ends(placed: Sequence[Placed], level: str) -> tuple[Message, ...]:
    """An EpochEnd after the last message of each epoch, those of a target in the order of its requests."""
    requests: dict[int, Request] = {}
    closes: dict[int, int] = {}
    listed: dict[int, dict[tuple[int, int], None]] = defaultdict(dict)
    for place, (message, epoch) in enumerate(placed):
        closes[epoch] = place
        if isinstance(message, Request):
            requests.setdefault(epoch, message)
        elif isinstance(message, MEASUREMENTS):
            listed[epoch][message.node_id, message.seq] = None  # a repeated packet is listed once
    latest: dict[int, int] = {}
    final = {request.target_id: epoch for epoch, request in requests.items()}
    ends: dict[int, list[EpochEnd]] = defaultdict(list)
    for epoch, request in requests.items():
        target = request.target_id
        latest[target] = max(latest.get(target, -1), closes[epoch])
        empty = EpochEnd(request.stamp_ns, target, request.seq, level, (), ())
        ends[latest[target]].append(end_of(empty, list(listed[epoch]), level, final[target] == epoch))
    return tuple(item for place, (message, _) in enumerate(placed) for item in (message, *ends[place]))
