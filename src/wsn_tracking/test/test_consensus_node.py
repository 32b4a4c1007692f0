"""An epoch of one node of system B: whom it waits for, and what it holds for later."""

import numpy as np
import pytest
from consensus_cases import SECOND, anchors_of, network_of
from consensus_field import POSITIONS, epochs, pair, reading

from wsn_tracking.errors import TrackingError
from wsn_tracking.trackers import consensus_inbox
from wsn_tracking.trackers.consensus_config import ConsensusConfig, LinkConfig, PriorConfig
from wsn_tracking.trackers.consensus_network import run_epoch
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.estimate import Kind, check_usable


def test_an_epoch_is_begun_once_and_finished_once():
    node, _ = pair()
    for call in (node.advance, node.finish):
        with pytest.raises(TrackingError, match='`begin` one first'):
            call()
    node.begin(reading(0))
    with pytest.raises(TrackingError, match='begins epoch 1 within epoch 0'):
        node.begin(reading(1))


def test_a_node_waits_for_its_neighbours_of_the_round_alone():
    node, other = pair()
    assert node.awaited == ()
    first, second = node.begin(reading(0)), other.begin(reading(0))
    assert node.awaited == (2,)
    node.receive(second)
    assert node.awaited == ()
    other.receive(first)
    assert node.advance().round == 1
    assert node.awaited == (2,)
    node.receive(other.advance())
    assert node.advance() is None
    assert node.awaited == ()
    estimate = node.finish()
    assert (estimate.source, estimate.kind, estimate.contributors, estimate.measurements) == (
        'consensus_1',
        Kind.CONSENSUS,
        (1, 2),
        (1,),
    )
    check_usable(estimate)


def test_a_share_of_a_later_epoch_is_held_and_one_of_an_earlier_is_dropped():
    node, other = pair(ConsensusConfig(rounds=1))
    shares = [other.begin(reading(0))]
    other.advance()
    other.finish()
    shares.append(other.begin(reading(1)))
    node.receive(shares[1])
    node.begin(reading(0))
    assert node.awaited == (2,)
    node.receive(shares[0])
    node.advance()
    node.finish()
    node.begin(reading(1))
    assert node.awaited == ()
    node.receive(shares[0])
    assert node.counters['foreign_epoch'] == 1


def test_shares_of_the_future_are_held_up_to_a_bound(monkeypatch):
    """Those of the nearest epochs: a stamp far in the future takes nobody's place."""
    monkeypatch.setattr(consensus_inbox, 'MAX_AHEAD', 3)
    node, other = pair()
    share = other.begin(reading(4))
    for k in (900, 901, 902, 0, 1, 2, 3, 1):
        node.receive(share._replace(request_seq=k, stamp_ns=k * SECOND))
    assert dict(node.counters) == {'share_overflow': 4, 'duplicate_share': 1}
    node.begin(reading(1))
    assert node.awaited == ()
    assert node.counters['foreign_epoch'] == 1


def test_a_round_that_nobody_answers_keeps_a_nodes_own_value():
    node, other = pair()
    node.begin(reading(0))
    before = node._now.rounds.value.copy()
    node.advance()
    np.testing.assert_array_equal(node._now.rounds.value, before)
    assert node.counters['missing_share'] == 1
    assert other.neighbours == (1,)


def test_neighbours_may_be_named():
    anchors = anchors_of(POSITIONS)
    node = ConsensusNode(ConsensusConfig(), anchors, 1, neighbours=(14, 5))
    assert node.neighbours == (5, 14)
    with pytest.raises(TrackingError, match='chebyshev needs the whole graph'):
        ConsensusNode(ConsensusConfig(scheme='chebyshev', rounds=30), anchors, 1, neighbours=(14, 5))
    with pytest.raises(TrackingError, match=r'nodes \[99\]'):
        ConsensusNode(ConsensusConfig(), anchors, 1, neighbours=(99,))
    with pytest.raises(TrackingError, match='name itself'):
        ConsensusNode(ConsensusConfig(), anchors, 1, neighbours=(5, 1))


def test_nodes_that_agree_say_so():
    few, many = (network_of(ConsensusConfig(rounds=L), POSITIONS) for L in (2, 40))
    for nodes in (few, many):
        run_epoch(nodes, epochs(0))
    assert max(node.disagreement for node in many.values()) < 0.2 * max(node.disagreement for node in few.values())


def test_a_configuration_that_contradicts_itself_is_refused():
    with pytest.raises(TrackingError, match='take four numbers'):
        ConsensusConfig(prior=PriorConfig(mean=(1.0, 2.0))).checked()
    with pytest.raises(TrackingError, match=r'before `link\.cut_from`'):
        ConsensusConfig(link=LinkConfig(cut_from=3, cut_until=2)).checked()
