"""From what a sink delivers to requests, measurements and epoch ends: the entry of live data.

Time decides here and nowhere else: an epoch is over `epoch_timeout` after the first word of it was read, steady time.
What comes later is still handed on; its consumers count it as late.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from wsn_tracking.sensing.values import NAN, EpochEnd, Range, Reason, Request, Rssi, TriggerReport
from wsn_tracking.zstack.beacons import Robot, pair
from wsn_tracking.zstack.intake import Taken
from wsn_tracking.zstack.payload import MAX_RECORDS, Flag, Payload, PayloadType
from wsn_tracking.zstack.records import RangeRecord, RssiRecord

KEPT = 256  # closed epochs of a target that late words can still be matched with
COUNTERS = ('too_old', 'unmapped_node', 'rssi_invalid', 'after_epoch_end')
TARGETS = 256  # remembered; a word of one more makes the one that was silent for longest a new one
Value = Request | Rssi | Range | EpochEnd | TriggerReport


class Rules(NamedTuple):
    """How words of the radio become values."""

    epoch_timeout_ns: int
    modality: int  # of ranges (sensing.values.Modality)
    node_ids: Mapping[int, int]  # radio id -> node id; empty: they are the same


@dataclass
class _Open:
    """An epoch that is still being reported."""

    request: Request
    due_ns: int
    topic: str = ''
    sent: list[tuple[int, int]] = field(default_factory=list)
    on_board: bool = False


class Bridge:
    """Feed it judged reports; it gives values in the order in which they are to be published."""

    def __init__(self, rules: Rules, steady_to_stamp_ns: int) -> None:
        self._rules = rules
        self._offset = steady_to_stamp_ns
        self._robots: dict[int, Robot] = {}
        self._open: dict[int, dict[int, _Open]] = {}
        self._stamps: dict[int, deque[tuple[int, int]]] = {}
        self._triggering: set[int] = set()  # nodes that have said that they trigger on board
        self.counters: Counter[str] = Counter(dict.fromkeys(COUNTERS, 0))

    def take(self, taken: Taken, now_ns: int) -> Iterator[Value]:
        """The values of one report, which was read from the line at `now_ns`; a duplicate has none."""
        payload = taken.report.payload
        if not taken.is_new or payload.type not in {PayloadType.RSSI, PayloadType.RANGE, PayloadType.WORN}:
            return
        for index, record in enumerate(payload.records):
            if isinstance(record, (RssiRecord, RangeRecord)):
                yield from self._record(taken, payload, index, record, now_ns)

    @property
    def next_due_ns(self) -> int | None:
        """When the next epoch is over; None while none is open."""
        return min((epoch.due_ns for epochs in self._open.values() for epoch in epochs.values()), default=None)

    def due(self, now_ns: int) -> Iterator[Value]:
        """The ends of the epochs that are over by now, each target's in order."""
        for target, epochs in list(self._open.items()):
            for seq in sorted(epochs):
                if epochs[seq].due_ns > now_ns:
                    break
                yield from self._end(epochs.pop(seq))
            if not epochs:
                del self._open[target]

    def _record(
        self, taken: Taken, payload: Payload, index: int, record: RssiRecord | RangeRecord, now_ns: int
    ) -> Iterator[Value]:
        measured_ns = taken.measured_ns(record.age_ms)
        worn = payload.type == PayloadType.WORN
        node = self._node(record.robot_id if worn else payload.node_id)
        target = payload.node_id if worn else record.robot_id
        if measured_ns is None or node is None:
            self.counters['too_old' if measured_ns is None else 'unmapped_node'] += 1
            return
        paired = pair(self._robots.pop(target, Robot()), record.beacon_seq, measured_ns)
        self._remember(target, paired.robot)
        seq = paired.request_seq
        if paired.first:
            yield self._ask(target, seq, measured_ns, now_ns)
        value = self._value(payload, index, record, node, target, seq)
        if value is None:
            self.counters['rssi_invalid'] += 1
            return
        self._list(target, seq, value, bool(payload.flags & Flag.EVENT_TRIGGERED))
        yield value

    def _remember(self, target: int, robot: Robot) -> None:
        self._robots[target] = robot
        if len(self._robots) > TARGETS:
            forgotten = next(iter(self._robots))
            del self._robots[forgotten], self._stamps[forgotten]

    def _node(self, radio: int) -> int | None:
        return self._rules.node_ids.get(radio) if self._rules.node_ids else radio

    def _ask(self, target: int, seq: int, measured_ns: int, now_ns: int) -> Request:
        request = Request(measured_ns + self._offset, target, seq)
        self._stamps.setdefault(target, deque(maxlen=KEPT)).append((seq, request.stamp_ns))
        self._open.setdefault(target, {})[seq] = _Open(request, now_ns + self._rules.epoch_timeout_ns)
        return request

    def _value(
        self, payload: Payload, index: int, record: RssiRecord | RangeRecord, node: int, target: int, seq: int
    ) -> Rssi | Range | None:
        stamp = dict(self._stamps[target]).get(seq, 0)
        number = (payload.seq or 0) * MAX_RECORDS + index
        if isinstance(record, RangeRecord):
            variance = (record.sigma_mm * 1e-3) ** 2 if record.sigma_mm else NAN
            return Range(stamp, node, target, number, seq, self._rules.modality, record.range_mm * 1e-3, variance)
        if record.rssi_dbm is None:
            return None
        sigma = record.sigma_db or NAN  # whole dB that are all alike have no spread, and are no surer for it
        return Rssi(stamp, node, target, number, seq, float(record.rssi_dbm), sigma, max(record.n_samples, 1))

    def _list(self, target: int, seq: int, value: Rssi | Range, on_board: bool) -> None:
        if on_board:
            self._triggering.add(value.node_id)
        epoch = self._open.get(target, {}).get(seq)
        if epoch is None:
            self.counters['after_epoch_end'] += 1
            return
        epoch.topic = 'range' if isinstance(value, Range) else 'rssi'
        epoch.sent.append((value.node_id, value.seq))
        epoch.on_board |= on_board

    def _end(self, epoch: _Open) -> Iterator[Value]:
        request = epoch.request
        nodes, seqs = tuple(node for node, _ in epoch.sent), tuple(seq for _, seq in epoch.sent)
        topic = epoch.topic or 'rssi'
        if epoch.on_board:
            silent = tuple(sorted(self._triggering - set(nodes)))
            sent = sorted(epoch.sent)
            yield TriggerReport(
                request.stamp_ns,
                request.target_id,
                request.seq,
                tuple(node for node, _ in sent),
                tuple(seq for _, seq in sent),
                silent,
                (int(Reason.ON_BOARD),) * len(silent),
            )
        yield EpochEnd(request.stamp_ns, request.target_id, request.seq, topic, nodes, seqs)
