"""Nodes of system B that live together: split in any way they compute the same, and no dead neighbour stops them."""

from __future__ import annotations

import numpy as np
import pytest
from consensus_cases import anchors_of, epoch_of, network_of

from wsn_tracking.trackers import consensus_group
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_group import ConsensusGroup
from wsn_tracking.trackers.consensus_network import run_epoch
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_share import Share
from wsn_tracking.trackers.estimate import Estimate

LINE = np.array([[0.0, 0.0, 0.0], [80.0, 30.0, 0.0], [160.0, 0.0, 0.0], [240.0, 30.0, 0.0]])
CONFIG = ConsensusConfig(rounds=4)
TIMEOUT = 0.1  # [s]
Z = np.array([[70.0, 0.8], [45.0, 2.0], [120.0, 2.7], [200.0, 3.0]])


def groups_of(*districts, head_start=0.0):
    anchors = anchors_of(LINE)
    return [
        ConsensusGroup({i: ConsensusNode(CONFIG, anchors, i) for i in ids}, TIMEOUT, head_start) for ids in districts
    ]


def carried(groups, now=0.0):
    """Carry shares between groups until nobody has anything to say: the estimates, and how many shares were sent."""
    estimates, sent, moved = [], 0, True
    while moved:
        moved = False
        for group in groups:
            for said in list(group.advance(now)):
                moved = True
                if isinstance(said, Estimate):
                    estimates.append(said)
                    continue
                sent += 1
                for other in groups:
                    if other is not group and said.node_id in other.foreign:
                        other.receive(said)
    return {e.source: e for e in estimates}, sent


@pytest.mark.parametrize('districts', [[(1, 2, 3, 4)], [(1, 2), (3, 4)], [(1, 3), (2, 4)], [(1,), (2,), (3,), (4,)]])
def test_however_the_nodes_are_split_they_compute_the_same(districts):
    groups, nodes = groups_of(*districts), network_of(CONFIG, LINE)
    for k in range(3):
        epoch = epoch_of(k, Z + k)
        for group in groups:
            group.begin(epoch)
        estimates, sent = carried(groups)
        assert sent == 4 * CONFIG.rounds
        for estimate in run_epoch(nodes, dict.fromkeys(nodes, epoch)).values():
            assert np.array_equal(estimates[estimate.source].mean, estimate.mean)
            assert np.array_equal(estimates[estimate.source].covariance, estimate.covariance)
    assert not any(group.counters for group in groups)


def test_a_group_knows_whose_shares_must_come_from_outside():
    left, right = groups_of((1, 2), (3, 4))
    assert (left.foreign, right.foreign) == ((3,), (2,))
    (whole,) = groups_of((1, 2, 3, 4))
    assert whole.foreign == ()


def test_a_dead_neighbour_costs_a_round_timeout_a_round_and_nothing_once_it_is_silent():
    left, _ = groups_of((1, 2), (3, 4))
    for k in range(CONFIG.silent_epochs):
        left.begin(epoch_of(k, Z))
        begun = 10.0 * k
        assert not [said for said in left.advance(begun) if isinstance(said, Estimate) and said.source.endswith('2')]
        for t in range(1, CONFIG.rounds):
            early = begun + t * TIMEOUT - 0.01
            left.look_at_time(early)
            assert not [said for said in left.advance(early) if said.round == t and said.node_id == 2]
            left.look_at_time(begun + t * TIMEOUT + 1e-9)
            assert (2, t) in ((s.node_id, s.round) for s in left.advance(begun + t * TIMEOUT + 1e-9))
        left.look_at_time(begun + CONFIG.rounds * TIMEOUT + 1e-9)
        assert 'consensus_2' in {s.source for s in left.advance(begun + 5.0) if isinstance(s, Estimate)}
    assert left.counters['missing_share'] == CONFIG.silent_epochs * CONFIG.rounds
    left.begin(epoch_of(CONFIG.silent_epochs, Z))
    assert {'consensus_1', 'consensus_2'} == {s.source for s in left.advance(99.0) if isinstance(s, Estimate)}


def test_whoever_begins_late_is_heard_within_the_head_start_of_the_others():
    """Processes do not begin an epoch at once; who is in its first round early waits, and no longer in later ones."""
    left, right = groups_of((1, 2), (3, 4), head_start=0.5)
    left.begin(epoch_of(0, Z))
    begun = list(left.advance(0.0))
    late = 0.5 + TIMEOUT - 0.01
    left.look_at_time(late)
    assert not list(left.advance(late))
    right.begin(epoch_of(0, Z))
    for said in begun:
        if isinstance(said, Share):
            right.receive(said)
    estimates, _ = carried([left, right], late)
    assert len(estimates) == 4
    assert not +left.counters
    assert not +right.counters


def test_who_was_silent_and_speaks_too_late_is_waited_for_in_the_next_epoch():
    """Nobody waits for a silent node, so its first shares come when the others have finished."""
    left, right = groups_of((1, 2), (3, 4))
    for k in range(CONFIG.silent_epochs + 1):
        left.begin(epoch_of(k, Z))
        for t in range(CONFIG.rounds + 1):
            left.look_at_time(10.0 * k + t)
            list(left.advance(10.0 * k + t))
    right.begin(epoch_of(CONFIG.silent_epochs, Z))
    for said in right.advance(90.0):
        if isinstance(said, Share):
            left.receive(said)
    assert left.counters['late_share'] > 0
    left.begin(epoch_of(CONFIG.silent_epochs + 1, Z))
    list(left.advance(100.0))
    assert left.nodes[2].awaited == (3,)


@pytest.mark.parametrize(('again', 'awaited'), [(False, (3,)), (True, ())])
def test_a_node_that_lags_by_an_epoch_is_waited_for_again_but_one_that_repeats_itself_is_not(again, awaited):
    """Node 3 has died; what comes of it in a later epoch is news of an earlier one, or was heard before."""
    left, right = groups_of((1, 2), (3, 4))
    right.begin(epoch_of(0, Z))
    first = next(said for said in right.advance(0.0) if isinstance(said, Share) and said.node_id == 3)
    for k in range(CONFIG.silent_epochs + 2):
        left.begin(epoch_of(k, Z))
        if k == 0:
            left.receive(first)
        for t in range(CONFIG.rounds + 1):
            left.look_at_time(10.0 * k + t)
            list(left.advance(10.0 * k + t))
    assert left.nodes[2].inbox.active == (1,)
    left.receive(first if again else first._replace(request_seq=3, stamp_ns=epoch_of(3, Z).stamp_ns))
    left.begin(epoch_of(CONFIG.silent_epochs + 2, Z))
    list(left.advance(100.0))
    assert left.nodes[2].awaited == awaited
    assert left.counters['foreign_epoch'] == 1


def test_a_group_that_cannot_keep_up_skips_epochs_and_counts_them(monkeypatch):
    monkeypatch.setattr(consensus_group, 'MAX_QUEUE', 2)
    (group,) = groups_of((1, 2, 3, 4))
    assert [group.begin(epoch_of(k, Z)) for k in range(4)] == [True, True, False, False]
    assert group.counters == {'skipped_epoch': 2}
    done = [(said.source, said.request_seq) for said in group.advance(0.0) if isinstance(said, Estimate)]
    assert sorted(done) == [(f'consensus_{i}', k) for i in (1, 2, 3, 4) for k in (0, 1)]
    assert group.begin(epoch_of(4, Z))


def test_epochs_queue_and_are_forgotten_by_a_reset():
    left, _ = groups_of((1, 2), (3, 4))
    for k in range(3):
        left.begin(epoch_of(k, Z))
    assert not [s for s in left.advance(0.0) if isinstance(s, Estimate) and s.source == 'consensus_2']
    left.reset()
    assert list(left.advance(0.0)) == []
    left.begin(epoch_of(7, Z))
    assert {s.request_seq for s in left.advance(0.0)} == {7}
