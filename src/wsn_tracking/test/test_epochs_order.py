"""Epochs do not depend on the order in which messages arrive."""

from __future__ import annotations

from collections import Counter, deque

from epoch_cases import NODES, Stream, end, give, interleaved, packet, report, stamp, unaccounted
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, Request

QUICK = settings(max_examples=60)
counts = st.lists(st.tuples(*[st.integers(0, 2)] * len(NODES)), min_size=1, max_size=6)
lists = st.sampled_from(['end', [NODES], [(1,), (2, 3)], [(1,), (2,), (3,)]])


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


def test_requests_in_the_wrong_order_are_sorted_while_their_epochs_are_open():
    assembler = EpochAssembler(NODES)
    for k in (0, 2, 1):
        give(assembler, Request(stamp(k), 1, k))
    for k in range(3):
        give(assembler, end(k, [], float(k)))
    assert [epoch.request_seq for epoch in assembler.closed(0.0)] == [0, 1, 2]
    assert assembler.runs == 0


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
