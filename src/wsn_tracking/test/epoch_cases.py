"""Streams of messages that the tests of epoch assembly share."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Sequence

from wsn_tracking.sensing.average import one_a_node
from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, EpochEnd, Request, Rssi, TriggerReport

START = 1_700_000_000_000_000_000
SECOND = 1_000_000_000
NODES = (1, 2, 3)

# Every message that is given is counted under one of these, opens an epoch as its request, or is held.
COUNTED = (
    'used', 'invalid', 'lists', 'late', 'late_list', 'late_request', 'duplicate', 'duplicate_request', 'other_target',
    'other_node', 'unknown_node', 'before_start', 'overflow', 'discarded_by_reset', 'stray_request',
)  # fmt: skip
NOT_MESSAGES = ('epochs', 'lost', 'lost_request', 'unlisted_epoch', 'renumbered')


def stamp(k: float) -> int:
    """Of the instant k seconds after the start [ns]."""
    return START + round(k * SECOND)


def packet(node: int, seq: int, epoch: int, at: float, dbm: float = -50.0, target: int = 1) -> Rssi:
    return Rssi(stamp(at), node, target, seq, epoch, dbm, 1.5)  # NaN would not equal itself


def end(epoch: int, packets: Sequence[Rssi], at: float, final: bool = False, target: int = 1) -> EpochEnd:
    nodes, seqs = tuple(p.node_id for p in packets), tuple(p.seq for p in packets)
    return EpochEnd(stamp(at), target, epoch, 'rssi', nodes, seqs, final)


def report(epoch: int, packets: Sequence[Rssi], nodes: Sequence[int], at: float, target: int = 1) -> TriggerReport:
    sent = [p for p in packets if p.node_id in nodes]
    ids, seqs = tuple(p.node_id for p in sent), tuple(p.seq for p in sent)
    silent = tuple(node for node in nodes if node not in ids)
    return TriggerReport(stamp(at), target, epoch, ids, seqs, silent, (3,) * len(silent))


def give(assembler: EpochAssembler, message: object, now: float = 0.0) -> None:
    """Hand a message to the method of its kind."""
    if isinstance(message, Request):
        assembler.request(message, now)
    elif isinstance(message, (EpochEnd, TriggerReport)):
        assembler.listing(message, now)
    else:
        assembler.measurement(message, now)


def unaccounted(assembler: EpochAssembler, given: int) -> int:
    """Messages that were neither used, nor counted, nor are held: always zero."""
    counters = assembler.counters
    assert set(counters) <= {*COUNTED, *NOT_MESSAGES}
    assert min(counters.values(), default=0) >= 0
    asked = counters['epochs'] - counters['lost_request']
    return given - sum(counters[name] for name in COUNTED) - asked - assembler.held


class Stream:
    """One run of a feed: what each publisher sends, and the epochs that it means."""

    def __init__(self, counts, lists, first=0, start=0.0, seq=0):
        """counts: packets by epoch and node; lists: 'end', or the groups of nodes that report together."""
        self.queues = {'request': deque(), **{f'node_{node}': deque() for node in NODES}}
        self.epochs = []
        sent = Counter(dict.fromkeys(NODES, seq))
        for k, row in enumerate(counts):
            epoch, at = first + k, start + k
            packets = []
            for node, count in zip(NODES, row, strict=True):
                for _ in range(count):
                    packets.append(packet(node, sent[node], epoch, at, -40.0 - node - 0.37 * sent[node]))
                    sent[node] += 1
            self._send('request', k, Request(stamp(at), 1, epoch))
            for p in packets:
                self._send(f'node_{p.node_id}', k, p)
            if lists == 'end':
                self._send('end', k, end(epoch, packets, at))
            else:
                for group in lists:
                    self._send(f'report_{group}', k, report(epoch, packets, group, at))
            self.epochs.append(Epoch(1, epoch, stamp(at), one_a_node(packets)))

    def _send(self, publisher, k, message):
        self.queues.setdefault(publisher, deque()).append((k, message))

    def __len__(self):
        return len(self.epochs)


def interleaved(queues, rng, ahead=math.inf):
    """Messages in an order that keeps each publisher's own; never `ahead` epochs before the one asked for by send."""
    queues = {name: deque(queue) for name, queue in queues.items()}
    closed = 0
    while any(queues.values()):
        ready = sorted(name for name, queue in queues.items() if queue and queue[0][0] < closed + ahead)
        _, message = queues[rng.choice(ready)].popleft()
        closed += (yield message) or 0


def run_of(numbers, at, assembler, now=0.0):
    """The numbers of the epochs that a feed of these requests, one a second from `at` on, is assembled to."""
    out = []
    for k, number in enumerate(numbers):
        give(assembler, Request(stamp(at + k), 1, number), now)
        give(assembler, end(number, [], at + k), now)
        out += assembler.closed(now)
    return [epoch.request_seq for epoch in out]
