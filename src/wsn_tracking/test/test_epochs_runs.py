"""A looped bag or a new feed is a new run; a target that counts anew is none."""

from __future__ import annotations

from epoch_cases import NODES, end, give, packet, report, run_of, stamp, unaccounted

from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, Request


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
