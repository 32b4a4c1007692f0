"""What is lost is waited for as long as it may take, and no longer, by a clock that the test moves."""

from __future__ import annotations

from collections import Counter

import pytest
from epoch_cases import NODES, end, give, packet, report, stamp, unaccounted

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, Request


def test_it_says_that_it_waits_for_the_first_request():
    assembler = EpochAssembler(NODES)
    give(assembler, packet(1, 0, 0, 0.0))
    assert assembler.waits_for == 'the first request'


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


def test_who_joins_a_lossless_feed_begins_with_the_first_epoch_that_is_whole():
    """The list of epoch 4 was sent before it was there, the packets of 5 came on a topic that was matched later."""
    assembler = EpochAssembler(NODES, loss_timeout=20.0, lossless=True)
    whole = packet(2, 6, 6, 6.0)
    give(assembler, Request(stamp(4), 1, 4), 10.0)
    give(assembler, packet(1, 4, 4, 4.0), 10.0)
    give(assembler, Request(stamp(5), 1, 5), 11.0)
    give(assembler, end(5, [packet(2, 5, 5, 5.0)], 5.0), 11.0)
    give(assembler, Request(stamp(6), 1, 6), 11.5)
    give(assembler, end(6, [whole], 6.0), 11.5)
    give(assembler, whole, 11.5)
    assert assembler.closed(13.4) == []
    assert assembler.closed(13.5) == [Epoch(1, 6, stamp(6), (whole,))]
    give(assembler, packet(3, 4, 4, 4.0), 13.6)
    assert {name: n for name, n in assembler.counters.items() if n} == {
        'before_start': 5, 'used': 1, 'lists': 1, 'epochs': 1
    }  # fmt: skip
    assert unaccounted(assembler, 8) == 0


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
