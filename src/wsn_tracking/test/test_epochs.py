"""Epochs do not depend on the order of arrival, and no message is dropped without a counter."""

from __future__ import annotations

import math
import random
from collections import Counter, deque

import pytest
from epoch_cases import NODES, SECOND, START, end, give, packet, report, stamp, unaccounted
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing import epochs as epochs_module
from wsn_tracking.sensing import open_epochs
from wsn_tracking.sensing.average import one_a_node
from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, EpochEnd, Range, Request, Rssi, TriggerReport

QUICK = settings(max_examples=60)


# ---- any order


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


counts = st.lists(st.tuples(*[st.integers(0, 2)] * len(NODES)), min_size=1, max_size=6)
lists = st.sampled_from(['end', [NODES], [(1,), (2, 3)], [(1,), (2,), (3,)]])


def interleaved(queues, rng, ahead=math.inf):
    """Messages in an order that keeps each publisher's own; never `ahead` epochs before the one asked for by send."""
    queues = {name: deque(queue) for name, queue in queues.items()}
    closed = 0
    while any(queues.values()):
        ready = sorted(name for name, queue in queues.items() if queue and queue[0][0] < closed + ahead)
        _, message = queues[rng.choice(ready)].popleft()
        closed += (yield message) or 0


@given(counts, lists, st.integers(0, 2**32 - 7), st.randoms(use_true_random=False))
@QUICK
def test_epochs_do_not_depend_on_the_order_of_arrival(rows, kind, first, rng):
    stream = Stream(rows, kind, first=first)
    assembler, out = EpochAssembler(NODES, lossless=True), []
    for count, message in enumerate(interleaved(stream.queues, rng), 1):
        give(assembler, message)
        out += assembler.closed(0.0)
        assert unaccounted(assembler, count) == 0
    assert out == stream.epochs
    assert assembler.held == 0
    assert assembler.counters['used'] == sum(map(sum, rows))
    assert set(assembler.counters) <= {'used', 'epochs', 'lists'}
    assert assembler.waits_for == ''


@given(counts, lists, st.randoms(use_true_random=False))
@QUICK
def test_repeated_messages_change_no_epoch(rows, kind, rng):
    """Any message may come again, at any later time; but a request of old would be that of a looped bag."""
    stream = Stream(rows, kind)
    assembler, out, seen = EpochAssembler(NODES, lossless=True), [], []
    for count, message in enumerate(interleaved(stream.queues, rng)):
        if isinstance(message, Request):
            seen = [m for m in seen if not isinstance(m, Request)]
        seen.append(message)
        for m in (message, rng.choice(seen)):
            give(assembler, m)
            out += assembler.closed(0.0)
        assert unaccounted(assembler, 2 * count + 2) == 0
    assert out == stream.epochs
    assert assembler.held == 0


@given(st.integers(4, 7), st.integers(4, 7), lists, st.booleans(), st.booleans(), st.randoms(use_true_random=False))
@QUICK
def test_a_new_run_loses_nothing_of_the_old_one_or_of_itself(one, two, kind, looped, goes_on, rng):
    """A looped bag, or a target that was restarted; the feed is at most a window ahead, so runs overlap on the way."""
    rows = [tuple(rng.randint(0, 2) for _ in NODES) for _ in range(max(one, two))]
    first = Stream(rows[:one], kind)
    later = Stream(rows[:two], kind, start=0.0 if looped else float(one), seq=50 * (goes_on and not looped))
    queues = {
        name: deque([*first.queues[name], *((k + one, m) for k, m in later.queues[name])]) for name in first.queues
    }
    assembler, out, count = EpochAssembler(NODES, lossless=True), [], 0
    order = interleaved(queues, rng, ahead=4)
    message = next(order)
    while message is not None:
        give(assembler, message)
        count += 1
        before = len(out)
        while closed := assembler.closed(0.0):
            out += [(assembler.runs, epoch) for epoch in closed]
        assert unaccounted(assembler, count) == 0
        try:
            message = order.send(len(out) - before)
        except StopIteration:
            message = None
    assert [epoch for _, epoch in out] == [*first.epochs, *later.epochs]
    assert [run for run, _ in out] == [0] * one + [int(looped)] * two
    assert {name: n for name, n in assembler.counters.items() if n} == {
        'epochs': one + two,
        'lists': assembler.counters['lists'],
        **({'used': used} if (used := sum(map(sum, rows[:one])) + sum(map(sum, rows[:two]))) else {}),
        **({} if looped else {'renumbered': 1}),
    }


# ---- conservation, and memory, under garbage


SMALL = st.integers(0, 6)
targets = st.sampled_from([1, 1, 1, 1, 2])
stamps = st.integers(0, 9).map(lambda k: START + k * SECOND // 2)
ids = st.integers(0, 4)
garbage_messages = st.one_of(
    st.builds(Request, stamps, targets, SMALL),
    st.builds(Rssi, stamps, ids, targets, st.integers(0, 3), SMALL, st.sampled_from([-50.0, -60.0, 127.0, math.nan])),
    st.tuples(stamps, targets, SMALL, st.lists(st.tuples(ids, st.integers(0, 3)), max_size=4)).map(
        lambda t: EpochEnd(*t[:3], 'rssi', tuple(n for n, _ in t[3]), tuple(s for _, s in t[3]))
    ),
    st.tuples(stamps, targets, SMALL, st.lists(ids, unique=True, max_size=4), st.integers(0, 4)).map(
        lambda t: TriggerReport(*t[:3], tuple(t[3][: t[4]]), (0,) * len(t[3][: t[4]]), tuple(t[3][t[4] :]), ())
    ),
)


@given(st.lists(st.tuples(garbage_messages, st.sampled_from([0.0, 0.0, 0.5, 3.0])), max_size=60))
@settings(max_examples=250)
def test_every_message_is_used_counted_once_or_held(steps):
    assembler, now = EpochAssembler((1, 2), known=(1, 2, 3), loss_timeout=1.0), 0.0
    numbers = []
    for count, (message, later) in enumerate(steps, 1):
        now += later
        give(assembler, message, now)
        assert unaccounted(assembler, count) == 0
        numbers += [(assembler.runs, epoch) for epoch in assembler.closed(now)]
        assert unaccounted(assembler, count) == 0
    for _, epoch in numbers:
        nodes = [p.node_id for p in epoch.measurements]
        assert nodes == sorted(set(nodes))
        assert set(nodes) <= {1, 2}
        assert epoch.target_id == assembler.target_id
    assert sum(assembler.counters[c] for c in ('epochs',)) == len(numbers)
    while assembler.closed(now := now + 10.0):
        pass
    assert unaccounted(assembler, len(steps)) == 0


def test_garbage_fills_no_memory_and_does_not_stop_the_target(monkeypatch):
    """Random numbers before and between the real messages; every real epoch still closes, in order and whole."""
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 20)
    monkeypatch.setattr(epochs_module, 'MAX_OPEN', 20)
    monkeypatch.setattr(open_epochs, 'MAX_SIZE', 60)
    rng = random.Random(3)
    assembler, out, count = EpochAssembler(NODES), [], 0
    stream = Stream([(1, 1, 1)] * 30, 'end', first=100)
    for k in range(30):
        for _ in range(50):
            number, node = rng.randrange(1000, 2**32), rng.choice(NODES)
            nonsense = [
                packet(node, rng.randrange(2**16), number, k),
                packet(node, rng.randrange(2**16), 1000, k),  # many packets of one epoch
                EpochEnd(stamp(k), 1, number, 'rssi', NODES * 3, tuple(rng.randrange(2**16) for _ in NODES * 3)),
            ]
            give(assembler, rng.choice(nonsense), float(k))
            count += 1
        for name in ('node_1', 'node_2', 'node_3', 'end', 'request'):
            give(assembler, stream.queues[name][k][1], float(k))
            count += 1
        out += assembler.closed(float(k))
        assert unaccounted(assembler, count) == 0
        assert assembler.held <= 60 + 9
    assert out == stream.epochs
    assert assembler.counters['overflow'] > 1000


def test_what_lies_furthest_in_the_future_gives_way(monkeypatch):
    """Of epochs that no request has asked for yet, the next are the likeliest to be real."""
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 3)
    assembler = EpochAssembler(NODES)
    for number in (11, 12, 500, 900, 13, 14, 800):
        give(assembler, packet(1, 0, number, 0.0))
    assert assembler.counters['overflow'] == 4
    for k, number in enumerate((11, 12, 13)):
        give(assembler, Request(stamp(k), 1, number))
        give(assembler, end(number, [packet(1, 0, number, 0.0)], float(k)))
    assert [len(epoch.measurements) for epoch in assembler.closed(0.0)] == [1, 1, 1]


def test_packets_without_end_of_one_epoch_do_not_keep_it_open(monkeypatch):
    monkeypatch.setattr(open_epochs, 'MAX_SIZE', 50)
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    for seq in range(500):
        give(assembler, packet(1, seq, 0, 0.0), 0.1 * seq)
    assert assembler.held == 51
    (epoch,) = assembler.closed(0.1 * 499)
    assert epoch.measurements[0].n_samples == 50
    assert assembler.counters['overflow'] == 450


def test_a_repeated_packet_is_no_news_and_does_not_keep_an_epoch_open():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    for k in range(12):
        give(assembler, packet(1, 0, 0, 0.0), 0.1 * k)
        give(assembler, end(0, [packet(1, 0, 0, 0.0), packet(2, 0, 0, 0.0)], 0.0), 0.1 * k)
    assert assembler.counters['duplicate'] == 11
    assert len(assembler.closed(1.0)) == 1


def test_too_many_epochs_are_closed_without_what_they_lack(monkeypatch):
    monkeypatch.setattr(open_epochs, 'MAX_OPEN', 10)
    monkeypatch.setattr(epochs_module, 'MAX_OPEN', 10)
    assembler, out = EpochAssembler(NODES), []
    for k in range(15):
        give(assembler, Request(stamp(k), 1, k))
        out += assembler.closed(0.0)
    assert [epoch.request_seq for epoch in out] == [0, 1, 2, 3, 4]
    assert assembler.counters['unlisted_epoch'] == 5
    assert assembler.held == 10


def test_the_messages_of_a_new_run_are_held_within_bounds(monkeypatch):
    monkeypatch.setattr(epochs_module, 'MAX_AHEAD', 3)
    assembler = EpochAssembler(NODES)
    give(assembler, Request(stamp(9), 1, 5))
    give(assembler, Request(stamp(0), 1, 0))
    for seq in range(4):
        give(assembler, packet(1, seq, 0, 0.0))
    assert assembler.counters['overflow'] == 2
    assert unaccounted(assembler, 6) == 0
    assert assembler.held == 1 + 3


# ---- each reason


def filled(**options):
    """An assembler that has closed epoch 5, and what it closed."""
    assembler = EpochAssembler(NODES, known=(1, 2, 3, 9), **options)
    give(assembler, Request(stamp(5), 1, 5))
    give(assembler, packet(1, 0, 5, 5.0))
    give(assembler, end(5, [packet(1, 0, 5, 5.0)], 5.0))
    return assembler, assembler.closed(0.0)


def test_an_epoch_without_a_measurement_still_happens():
    assembler = EpochAssembler(NODES)
    give(assembler, Request(stamp(0), 1, 0))
    assert assembler.closed(0.0) == []
    give(assembler, end(0, [], 0.0))
    assert assembler.closed(0.0) == [Epoch(1, 0, stamp(0), ())]


@pytest.mark.parametrize(
    ('message', 'reason'),
    [
        (packet(1, 1, 5, 5.0), 'late'),
        (packet(1, 1, 4, 4.0), 'before_start'),
        (end(5, [], 5.0), 'late_list'),
        (Request(stamp(5), 1, 5), 'late_request'),
        (Request(stamp(4.5), 1, 4), 'late_request'),
        (packet(1, 1, 6, 6.0, target=2), 'other_target'),
        (end(6, [], 6.0, target=2), 'other_target'),
        (Request(stamp(6), 2, 6), 'other_target'),
        (packet(9, 1, 6, 6.0), 'other_node'),
        (report(6, [], (9,), 6.0), 'other_node'),
        (packet(8, 1, 6, 6.0), 'unknown_node'),
    ],
)
def test_what_is_not_used_is_counted_under_its_reason(message, reason):
    assembler, (epoch,) = filled()
    assert [p.node_id for p in epoch.measurements] == [1]
    before = assembler.counters.copy()
    give(assembler, message)
    assert assembler.counters - before == Counter([reason])
    assert assembler.closed(100.0) == []
    assert assembler.held == 0


def test_duplicates_are_counted():
    assembler, _ = filled()
    for message in (packet(1, 1, 6, 6.0), Request(stamp(6), 1, 6), packet(2, 1, 6, 6.0)):
        give(assembler, message)
        give(assembler, message)
    assert assembler.counters['duplicate'] == 2
    assert assembler.counters['duplicate_request'] == 1
    give(assembler, end(6, [packet(1, 1, 6, 6.0), packet(2, 1, 6, 6.0)], 6.0))
    (epoch,) = assembler.closed(0.0)
    assert [(p.node_id, p.n_samples) for p in epoch.measurements] == [(1, 1), (2, 1)]


def test_what_the_list_does_not_name_came_too_late_whenever_it_arrives():
    """A bridge's verdict, recorded in the bag: a packet after the deadline is not used in any order of replay."""
    late = packet(2, 7, 0, 0.0)
    messages = [Request(stamp(0), 1, 0), packet(1, 0, 0, 0.0), end(0, [packet(1, 0, 0, 0.0)], 0.0)]
    for place in range(4):
        assembler, out = EpochAssembler(NODES), []
        for message in [*messages[:place], late, *messages[place:]]:
            give(assembler, message)
            out += assembler.closed(0.0)
        assert out == [Epoch(1, 0, stamp(0), (packet(1, 0, 0, 0.0),))]
        assert assembler.counters['late'] == 1


def test_messages_before_the_first_request_are_not_waited_for_in_any_order():
    """A recording that begins in the middle of an epoch."""
    old = packet(1, 3, 4, 4.0)
    new = [Request(stamp(5), 1, 5), packet(1, 4, 5, 5.0), end(5, [packet(1, 4, 5, 5.0)], 5.0)]
    for place in range(4):
        assembler, out = EpochAssembler(NODES, lossless=True), []
        for message in [*new[:place], old, *new[place:]]:
            give(assembler, message)
            out += assembler.closed(0.0)
        assert [epoch.request_seq for epoch in out] == [5]
        assert assembler.counters['before_start'] == 1
        assert unaccounted(assembler, 4) == 0


def test_the_target_is_the_one_given_or_the_first_that_is_heard():
    assembler = EpochAssembler(NODES)
    give(assembler, packet(1, 0, 0, 0.0, target=7))
    give(assembler, packet(1, 0, 0, 0.0, target=1))
    assert (assembler.target_id, assembler.counters['other_target']) == (7, 1)
    assembler = EpochAssembler(NODES, target_id=1)
    give(assembler, packet(1, 0, 0, 0.0, target=7))
    assert (assembler.target_id, assembler.counters['other_target']) == (1, 1)


def test_values_that_cannot_be_true_are_counted_as_invalid():
    assembler = EpochAssembler((1, 2))
    sent = [packet(1, 0, 0, 0.0, 127.0), packet(1, 1, 0, 0.0, -60.0), packet(2, 0, 0, 0.0, -128.0)]
    for message in (Request(stamp(0), 1, 0), *sent, end(0, sent, 0.0)):
        give(assembler, message)
    (epoch,) = assembler.closed(0.0)
    assert [p.rssi_dbm for p in epoch.measurements] == [-60.0, -128.0]
    assert (assembler.counters['used'], assembler.counters['invalid']) == (1, 2)


# ---- losses, by a clock that the test moves


def test_a_lost_measurement_closes_its_epoch_after_the_timeout_alone():
    assembler = EpochAssembler(NODES, loss_timeout=2.0)
    give(assembler, Request(stamp(0), 1, 0), 10.0)
    give(assembler, end(0, [packet(1, 0, 0, 0.0), packet(2, 4, 0, 0.0)], 0.0), 11.0)
    give(assembler, packet(1, 0, 0, 0.0), 11.5)
    assert assembler.waits_for == 'epoch 0: the measurements (node, seq) [(2, 4)]'
    assert assembler.closed(13.4) == []
    (epoch,) = assembler.closed(13.5)
    assert [p.node_id for p in epoch.measurements] == [1]
    assert assembler.counters == Counter(lost=1, used=1, lists=1, epochs=1)
    give(assembler, packet(2, 4, 0, 0.0), 14.0)
    assert assembler.counters['late'] == 1


def test_epochs_behind_one_that_waits_close_with_it():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    for k in range(3):
        give(assembler, Request(stamp(k), 1, k))
        if k != 0:
            give(assembler, end(k, [], float(k)))
    assert assembler.closed(0.9) == []
    assert [epoch.request_seq for epoch in assembler.closed(1.0)] == [0, 1, 2]
    assert assembler.counters['unlisted_epoch'] == 1


def test_where_nobody_lists_anything_time_closes_every_epoch_with_what_has_come():
    """A foreign bag without lists: also after three epochs, a request alone does not close its epoch."""
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    for k in range(8):
        give(assembler, Request(stamp(k), 1, k), float(k))
        assert assembler.closed(float(k)) == []
        give(assembler, packet(1, k, k, k), k + 0.1)
        (epoch,) = assembler.closed(k + 1.2)
        assert [p.node_id for p in epoch.measurements] == [1]
    assert assembler.counters['unlisted_epoch'] == 8


def test_a_lost_request_takes_the_stamp_of_what_answered_it():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    give(assembler, end(0, [], 0.0))
    give(assembler, end(1, [], 1.0))
    give(assembler, packet(1, 0, 2, 2.0))
    give(assembler, end(2, [packet(1, 0, 2, 2.0)], 2.0))
    assert len(assembler.closed(0.0)) == 1
    assert assembler.closed(100.0) == []  # its request may still be on its way
    give(assembler, Request(stamp(3), 1, 3), 100.0)
    give(assembler, end(3, [], 3.0), 100.0)
    assert assembler.waits_for == 'epoch 1: its request'
    out = assembler.closed(100.0)
    assert [(epoch.request_seq, epoch.stamp_ns) for epoch in out] == [(k, stamp(k)) for k in (1, 2, 3)]
    assert assembler.counters['lost_request'] == 2


def test_a_request_after_its_epoch_was_given_up_is_late_and_begins_no_run():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    give(assembler, end(0, [], 0.0))
    give(assembler, end(1, [], 1.0))
    give(assembler, Request(stamp(2), 1, 2))
    assert [epoch.request_seq for epoch in assembler.closed(5.0)] == [0, 1, 2]
    give(assembler, Request(stamp(1), 1, 1))
    assert assembler.counters['late_request'] == 1
    assert (assembler.counters['renumbered'], assembler.runs, assembler.closed(99.0)) == (0, 0, [])


@pytest.mark.parametrize(
    'lacking', ['its request', 'the list of nodes [1, 2, 3]', 'the measurements (node, seq) [(1, 0)]']
)
def test_where_nothing_may_be_missing_a_loss_is_an_error_that_names_it(lacking):
    assembler = EpochAssembler(NODES, loss_timeout=1.0, lossless=True)
    give(assembler, Request(stamp(0), 1, 0))
    give(assembler, end(0, [], 0.0))
    if lacking != 'its request':
        give(assembler, Request(stamp(1), 1, 1))
    if 'list' not in lacking:
        give(assembler, end(1, [packet(1, 0, 1, 1.0)] if 'measurements' in lacking else [], 1.0))
    give(assembler, Request(stamp(2), 1, 2))
    assert [epoch.request_seq for epoch in assembler.closed(0.9)] == [0]
    with pytest.raises(TrackingError) as error:
        assembler.closed(1.0)
    assert f'epoch 1 lacks {lacking}: nothing may be missing in a replay' in str(error.value)
    assert '`loss_timeout`' in str(error.value)


def test_a_node_that_stops_reporting_is_not_waited_for_after_three_epochs_until_it_reports():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)

    def epoch(k, nodes, now):
        give(assembler, Request(stamp(k), 1, k), now)
        give(assembler, report(k, [], nodes, float(k)), now)
        return len(assembler.closed(now))

    for k in range(3):
        assert epoch(k, (1, 2), float(k)) == 0
        assert len(assembler.closed(k + 1.0)) == 1
    assert assembler.counters['unlisted_epoch'] == 3
    assert epoch(3, (1, 2), 4.0) == 1
    assert epoch(4, (1, 2), 5.0) == 1
    give(assembler, report(4, [], (3,), 4.0), 5.1)  # it speaks again, though others were faster
    assert assembler.counters['late_list'] == 1
    assert epoch(5, (1, 2), 6.0) == 0
    give(assembler, report(5, [], (3,), 5.0), 6.1)
    assert len(assembler.closed(6.1)) == 1
    assert assembler.counters['unlisted_epoch'] == 3


def test_unlisted_packets_of_a_node_whose_list_is_lost_are_used():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    give(assembler, Request(stamp(0), 1, 0))
    give(assembler, packet(3, 0, 0, 0.0))
    give(assembler, report(0, [], (1, 2), 0.0))
    assert assembler.closed(0.5) == []
    (epoch,) = assembler.closed(1.0)
    assert [p.node_id for p in epoch.measurements] == [3]


def test_lists_of_two_kinds_agree():
    """A bag of ranges holds an EpochEnd and reports; whichever comes second tells nothing new."""
    sent = [packet(1, 0, 0, 0.0)]
    tellers = [end(0, sent, 0.0), report(0, sent, NODES, 0.0)]
    for order in (tellers, tellers[::-1]):
        assembler = EpochAssembler(NODES, lossless=True)
        for message in (Request(stamp(0), 1, 0), *order):
            give(assembler, message)
        assert assembler.closed(0.0) == []
        give(assembler, sent[0])
        assert len(assembler.closed(0.0)) == 1
        assert assembler.counters == Counter(used=1, epochs=1, lists=2)


# ---- new runs


def run_of(numbers, at, assembler, now=0.0):
    out = []
    for k, number in enumerate(numbers):
        give(assembler, Request(stamp(at + k), 1, number), now)
        give(assembler, end(number, [], at + k), now)
        out += assembler.closed(now)
    return [epoch.request_seq for epoch in out]


def test_requests_that_fall_back_by_more_than_a_second_are_a_new_run():
    assembler = EpochAssembler(NODES)
    assert run_of(range(5), 0.0, assembler) == [0, 1, 2, 3, 4]
    assert run_of(range(3), 0.0, assembler) == [0, 1, 2]
    assert assembler.runs == 1


def test_a_new_run_may_begin_at_a_higher_number():
    """A bag that was left early, and another one from its middle; what overtook its first request is not lost."""
    assembler = EpochAssembler(NODES, lossless=True)
    assert run_of(range(3), 100.0, assembler) == [0, 1, 2]
    give(assembler, packet(1, 0, 50, 10.0))
    give(assembler, end(50, [packet(1, 0, 50, 10.0)], 10.0))
    give(assembler, packet(1, 1, 51, 11.0))
    assert assembler.closed(99.0) == []
    give(assembler, Request(stamp(10), 1, 50))
    give(assembler, Request(stamp(11), 1, 51))
    give(assembler, end(51, [packet(1, 1, 51, 11.0)], 11.0))
    out = assembler.closed(0.0)
    assert [(epoch.request_seq, len(epoch.measurements)) for epoch in out] == [(50, 1), (51, 1)]
    assert (assembler.runs, assembler.counters['discarded_by_reset']) == (1, 0)


def test_a_run_that_was_cut_off_is_dropped_and_counted_when_another_begins():
    assembler = EpochAssembler(NODES, loss_timeout=1.0, lossless=True)
    assert run_of(range(3), 100.0, assembler) == [0, 1, 2]
    give(assembler, Request(stamp(103), 1, 3))
    give(assembler, packet(1, 0, 3, 103.0))  # the player was ended here
    assert run_of(range(2), 0.0, assembler, now=0.5) == []
    assert assembler.closed(1.0) == []
    assert assembler.counters['discarded_by_reset'] == 2
    assert [epoch.request_seq for epoch in assembler.closed(1.0)] == [0, 1]
    assert assembler.runs == 1
    assert unaccounted(assembler, 6 + 2 + 4) == 0


def test_small_steps_back_are_no_new_run():
    assembler = EpochAssembler(NODES)
    assert run_of([0, 1, 2], 10.0, assembler) == [0, 1, 2]
    give(assembler, Request(stamp(11.5), 1, 3))  # stamps out of order, numbers in order
    give(assembler, end(3, [], 11.5))
    assert [epoch.stamp_ns for epoch in assembler.closed(0.0)] == [stamp(11.5)]
    assert (assembler.runs, assembler.counters['renumbered']) == (0, 0)


def test_requests_in_the_wrong_order_are_sorted_while_their_epochs_are_open():
    assembler = EpochAssembler(NODES)
    for k in (0, 2, 1):
        give(assembler, Request(stamp(k), 1, k))
    for k in range(3):
        give(assembler, end(k, [], float(k)))
    assert [epoch.request_seq for epoch in assembler.closed(0.0)] == [0, 1, 2]
    assert assembler.runs == 0


def test_a_target_that_counts_anew_is_no_new_run():
    assembler = EpochAssembler(NODES)
    assert run_of([7, 8, 9], 0.0, assembler) == [7, 8, 9]
    assert run_of([0, 1], 3.0, assembler) == [0, 1]
    assert run_of([0, 1], 5.0, assembler) == [0, 1]
    assert (assembler.runs, assembler.counters['renumbered']) == (0, 2)


def test_equal_numbers_of_two_runs_are_told_apart_by_their_stamps():
    """The target restarts while its epoch of the same number is still open."""
    assembler = EpochAssembler(NODES, lossless=True)
    give(assembler, Request(stamp(0), 1, 0))
    give(assembler, Request(stamp(1), 1, 0))
    new, old = packet(1, 0, 0, 1.0), packet(1, 0, 0, 0.0)
    for message in (new, end(0, [new], 1.0), old, end(0, [old], 0.0)):
        give(assembler, message)
    assert assembler.closed(0.0) == [Epoch(1, 0, stamp(0), (old,))]
    assert assembler.closed(0.0) == [Epoch(1, 0, stamp(1), (new,))]
    assert (assembler.runs, assembler.counters['renumbered']) == (0, 1)


def test_a_node_that_was_given_up_is_waited_for_in_a_new_run():
    assembler = EpochAssembler(NODES, loss_timeout=1.0)
    for k in range(4):
        give(assembler, Request(stamp(k), 1, k))
        give(assembler, report(k, [], (1, 2), float(k)))
    assert len(assembler.closed(9.0)) == 4
    assert assembler.counters['unlisted_epoch'] == 3
    give(assembler, Request(stamp(0), 1, 0), 9.0)
    give(assembler, report(0, [], (1, 2), 0.0), 9.0)
    give(assembler, Request(stamp(1), 1, 1), 9.0)
    assert assembler.closed(9.5) == []
    assert assembler.waits_for == 'epoch 0: the list of nodes [3]'


def test_one_request_with_a_bad_stamp_is_no_new_run():
    """A clock of 1970 in the midst of a run: the request and what names it are counted, the run goes on."""
    assembler = EpochAssembler(NODES, lossless=True)
    for k in (0, 1):
        sent = [packet(1, k, k, float(k))]
        for message in (Request(stamp(k), 1, k), *sent, end(k, sent, float(k))):
            give(assembler, message)
    give(assembler, Request(0, 1, 7))
    assert [epoch.request_seq for epoch in assembler.closed(0.0)] == [0, 1]
    sent = [packet(1, 2, 2, 2.0)]
    for message in (Request(stamp(2), 1, 2), *sent, end(2, sent, 2.0)):
        give(assembler, message)
    assert assembler.closed(0.0) == [Epoch(1, 2, stamp(2), (sent[0],))]
    assert (assembler.runs, assembler.counters['stray_request']) == (0, 1)


def test_it_says_that_it_waits_for_the_first_request():
    assembler = EpochAssembler(NODES)
    give(assembler, packet(1, 0, 0, 0.0))
    assert assembler.waits_for == 'the first request'


def test_ranges_are_assembled_like_signal_strengths():
    assembler = EpochAssembler((1,))
    sent = Range(stamp(0), 1, 1, 0, 0, 1, 2.5, 0.01)
    for message in (Request(stamp(0), 1, 0), sent, end(0, [sent], 0.0)):
        give(assembler, message)
    assert assembler.closed(0.0) == [Epoch(1, 0, stamp(0), (sent,))]
