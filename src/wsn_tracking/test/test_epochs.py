"""What an epoch holds; what it does not use is counted under its reason."""

from __future__ import annotations

from collections import Counter

import pytest
from epoch_cases import NODES, end, give, packet, report, stamp

from wsn_tracking.sensing.epochs import EpochAssembler
from wsn_tracking.sensing.values import Epoch, Range, Request


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


def test_ranges_are_assembled_like_signal_strengths():
    assembler = EpochAssembler((1,))
    sent = Range(stamp(0), 1, 1, 0, 0, 1, 2.5, 0.01)
    for message in (Request(stamp(0), 1, 0), sent, end(0, [sent], 0.0)):
        give(assembler, message)
    assert assembler.closed(0.0) == [Epoch(1, 0, stamp(0), (sent,))]


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
