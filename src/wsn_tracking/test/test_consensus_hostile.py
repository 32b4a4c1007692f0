"""What no honest node can have said is counted and changes nothing; what honest nodes say passes."""

import numpy as np
import pytest
from consensus_cases import epoch_of, network_of
from consensus_field import POSITIONS, Z, pair, reading
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.trackers.consensus_config import ConsensusConfig, ObservationConfig
from wsn_tracking.trackers.consensus_share import bitmap, to_bytes


def test_late_doubled_foreign_and_broken_shares_are_counted_and_change_nothing():
    node, other = pair(ConsensusConfig(rounds=3))
    share = other.begin(reading(0))
    node.begin(reading(0))
    node.receive(share)
    good = node._now.rounds.value.copy()
    node.receive(share)
    wrong = {
        'duplicate_share': share,
        'not_a_neighbour': share._replace(node_id=9),
        'foreign_epoch': share._replace(request_seq=5),
        'malformed_share': share._replace(information=share.information[:-1]),
    }
    for broken in wrong.values():
        node.receive(broken)
    for broken in (
        share._replace(scheme='cm'),
        share._replace(information=(float('nan'),) * 10),
        share._replace(information_vector=(float('inf'),) * 4),
        share._replace(item_ids=(1,), items=(0.0,) * 14),
        share._replace(information_vector=share.information_vector[:3], information=(0.0, *share.information)),
        share._replace(round=3),
    ):
        node.receive(broken)
    assert dict(node.counters) == {**dict.fromkeys(wrong, 1), 'duplicate_share': 2, 'malformed_share': 7}
    np.testing.assert_array_equal(node._now.rounds.value, good)
    node.advance()
    node.receive(share)
    assert node.counters['late_share'] == 1


def negated(numbers):
    return tuple(-x for x in numbers)


HOSTILE = {
    'too few numbers': lambda s: s._replace(information=s.information[:-1]),
    'numbers of the other kind': lambda s: s._replace(information_vector=s.items[:4], information=s.items[4:14]),
    'an item less': lambda s: s._replace(items=s.items[:-14]),
    'an item more': lambda s: s._replace(item_ids=(*s.item_ids, 1)),
    'NaN': lambda s: s._replace(information=(float('nan'),) * len(s.information), items=(float('nan'),) * len(s.items)),
    'infinities that cancel': lambda s: s._replace(
        information=(float('inf'), float('-inf'), *s.information[2:]),
        items=(float('inf'), float('-inf'), *s.items[2:]),
    ),
    'numbers that overflow': lambda s: s._replace(
        information=tuple(1e308 * x for x in s.information), items=tuple(1e308 * x for x in s.items)
    ),
    'negative definite': lambda s: s._replace(information=negated(s.information), items=negated(s.items)),
    'a scheme of another network': lambda s: s._replace(scheme='hcmci'),
    'a round that there is not': lambda s: s._replace(round=65535),
    'more neighbours than nodes': lambda s: s._replace(degree=65535),
    'a huge bitmap': lambda s: s._replace(live=b'\xff' * 100_000),
    'a bitmap with a stranger': lambda s: s._replace(live=to_bytes(bitmap([2, 77]))),
}


@pytest.mark.parametrize('scheme', ['cm', 'icf', 'flood'])
@pytest.mark.parametrize('hostile', HOSTILE.values(), ids=HOSTILE.keys())
def test_what_no_node_can_have_said_is_counted_and_changes_nothing(scheme, hostile):
    node, other = pair(ConsensusConfig(scheme=scheme, rounds=2))
    share = other.begin(reading(0))
    node.begin(reading(0))
    wrong = hostile(share)
    node.receive(wrong)
    assert dict(node.counters) == ({} if wrong == share else {'malformed_share': 1})
    assert node.awaited == (() if wrong == share else (2,))


def test_a_flood_takes_no_item_of_a_node_that_there_is_not():
    node, other = pair(ConsensusConfig(scheme='flood', rounds=2))
    share = other.begin(reading(0))
    with pytest.raises(TrackingError, match=r'tells of nodes \[77\] that the anchors do not name'):
        node.door.check(share._replace(item_ids=(77,)))
    assert node.door.check(share) is share


@given(st.sampled_from(['cm', 'icf', 'hcmci', 'flood']), st.integers(0, 11))
@settings(properties, max_examples=20)
def test_whatever_honest_nodes_say_passes_the_door(scheme, k):
    """Averages of matrices of rank one or two are semidefinite to rounding alone."""
    nodes = network_of(ConsensusConfig(scheme=scheme, rounds=12), POSITIONS)
    said = {i: node.begin(epoch_of(k, Z[k])) for i, node in nodes.items()}
    while any(said.values()):
        for node in nodes.values():
            for j in node.neighbours:
                node.receive(said[j])
        said = {i: node.advance() for i, node in nodes.items()}
    assert not any(+node.counters for node in nodes.values())


def test_an_average_that_has_lost_its_definiteness_leaves_a_node_with_what_it_knows_alone():
    """As accelerated rounds may; such rows pass the door of an accelerated network."""
    kalman = ObservationConfig(linearisation_epochs=1.0)  # for which it makes no difference how many live
    node, other = pair(ConsensusConfig(rounds=2, observation=kalman))
    alone, _ = pair(ConsensusConfig(rounds=0, observation=kalman))
    assert alone.begin(reading(0)) is None
    share = other.begin(reading(0))
    node.begin(reading(0))
    node.take(share._replace(information=tuple(-1e6 * x for x in share.information)))
    node.advance()
    node.advance()
    assert node.finish().mean == pytest.approx(alone.finish().mean, abs=1e-9)
    assert np.isnan(node.disagreement)
