"""Tracker objects of system B that hear each other by shares alone."""

import gc
import itertools

import numpy as np
import pytest
from consensus_cases import SECOND, R, anchors_of, epoch_of, network_of
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.consensus_runs import sample
from wsn_tracking.evaluation.run_consensus import run_consensus
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Range, RangeBearing, Rssi
from wsn_tracking.simulation.b_field import FieldConfig, b_field
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers import consensus_inbox
from wsn_tracking.trackers.consensus import Network
from wsn_tracking.trackers.consensus_config import ConsensusConfig, LinkConfig, PriorConfig, noise_of
from wsn_tracking.trackers.consensus_network import run_epoch
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_share import bitmap, ids_of, to_bytes
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.observation import observation_of

SMALL = FieldConfig(nodes=14, width=190.0, depth=210.0, epochs=12)
WORLDS = sample(SMALL, 1, 4)
POSITIONS, Z = WORLDS.positions[0], WORLDS.z[0]
IDS = range(1, 15)
SCHEMES = ['cm', 'icf', 'flood', 'hcmci', 'chebyshev']
FAULTS = {
    'none': LinkConfig(),
    'loss': LinkConfig(loss=0.3, seed=5),
    'cut': LinkConfig(cut_at=95.0, cut_from=3, cut_until=8),
}


def epochs(k, living=IDS):
    return dict.fromkeys(living, epoch_of(k, Z[k]))


def compare(config, positions, z, dead=()):
    """Largest difference between tracker objects and the batched form, over all epochs; `dead` from epoch 4 to 9."""
    network, nodes = Network(config, positions), network_of(config, positions)
    state, worst = network.start(), 0.0
    for k in range(len(z)):
        alive = np.array([not (i in dead and k >= 4) for i in nodes])
        told = np.where(alive[:, None], z[k], np.nan)
        state, _ = network.step(state, k, 1.0 if k else 0.0, told, R, alive)
        estimates = run_epoch(nodes, {i: epoch_of(k, z[k]) for i, lives in zip(nodes, alive, strict=True) if lives})
        for i, estimate in estimates.items():
            worst = max(worst, np.abs(estimate.mean - state.belief.m[i - 1]).max())
            worst = max(worst, np.abs(estimate.covariance - state.belief.P[i - 1]).max())
            assert nodes[i].arrival_probability == pytest.approx(state.mu[i - 1], abs=2e-6)
    return worst


# --- one by one and all at once


@pytest.mark.parametrize('scheme', SCHEMES)
@pytest.mark.parametrize('fault', FAULTS)
def test_nodes_by_shares_equal_the_batched_form(scheme, fault):
    """Losses included, since both draw them by the same keys."""
    config = ConsensusConfig(scheme=scheme, rounds=14, link=FAULTS[fault])
    assert compare(config, POSITIONS, Z) < 1e-9
    assert compare(config, POSITIONS, Z[:9], dead=(2, 9)) < 1e-9


def test_the_documents_field_by_shares_equals_the_batched_form():
    worlds = sample(FieldConfig(epochs=3), 1, 1)
    assert compare(ConsensusConfig(), worlds.positions[0], worlds.z[0]) < 1e-9


def test_batched_runs_equal_runs_one_by_one():
    worlds = sample(SMALL, 3, 8)
    config = ConsensusConfig(link=LinkConfig(loss=0.2), rounds=6)
    whole = Network(config, worlds.positions, link_seeds=np.arange(3))
    ones = [Network(config, worlds.positions[r], link_seeds=r) for r in range(3)]
    state, states = whole.start(), [one.start() for one in ones]
    for k in range(6):
        state, _ = whole.step(state, k, 1.0 if k else 0.0, worlds.z[:, k], R)
        states = [
            one.step(s, k, 1.0 if k else 0.0, worlds.z[r, k], R)[0]
            for r, (one, s) in enumerate(zip(ones, states, strict=True))
        ]
    for r in range(3):
        assert state.belief.m[r] == pytest.approx(states[r].belief.m, abs=1e-9)


# --- order and ownership


def deliver(nodes, k, order):
    """One epoch in which every node's shares arrive in the order that `order` gives."""
    said = {i: node.begin(epoch_of(k, Z[k])) for i, node in nodes.items()}
    while any(said.values()):
        for node in nodes.values():
            for j in order([j for j in node.neighbours if said[j]]):
                node.receive(said[j])
        said = {i: node.advance() for i, node in nodes.items()}
    return [node.finish() for node in nodes.values()]


@settings(properties, max_examples=10)
@given(st.sampled_from(SCHEMES), st.randoms(use_true_random=False))
def test_estimates_do_not_depend_on_neighbour_order(scheme, random):
    """Not even in the last bit."""
    config = ConsensusConfig(scheme=scheme, rounds=12)
    plain, shuffled = network_of(config, POSITIONS), network_of(config, POSITIONS)
    for k in range(2):
        first = deliver(plain, k, list)
        second = deliver(shuffled, k, lambda ids: random.sample(ids, len(ids)))
        for a, b in zip(first, second, strict=True):
            assert (a.mean.tobytes(), a.covariance.tobytes()) == (b.mean.tobytes(), b.covariance.tobytes())


def arrays_of(thing):
    """Every array that an object can reach, but those of modules, classes and functions."""
    found, seen, queue = [], set(), [thing]
    while queue:
        item = queue.pop()
        if id(item) in seen or isinstance(item, type) or callable(item) or type(item).__name__ == 'module':
            continue
        seen.add(id(item))
        if isinstance(item, np.ndarray):
            found.append(item)
        queue += gc.get_referents(item)
    return found


@pytest.mark.parametrize('scheme', ['icf', 'flood'])
def test_no_array_is_shared_between_nodes(scheme):
    """In the middle of an epoch, with shares held; what they share is what they were made of, the table of anchors."""
    nodes = network_of(ConsensusConfig(scheme=scheme, rounds=6), POSITIONS)
    run_epoch(nodes, epochs(0))
    said = {i: node.begin(epoch_of(1, Z[1])) for i, node in nodes.items()}
    for node in nodes.values():
        for j in node.neighbours:
            node.receive(said[j])
    for node in nodes.values():
        node.advance()
    owned = {i: arrays_of(node) for i, node in nodes.items()}
    assert all(len(arrays) > 5 for arrays in owned.values())
    for i, j in itertools.combinations(nodes, 2):
        assert not any(
            np.shares_memory(a, b) for a in owned[i] for b in owned[j] if a.flags.writeable or b.flags.writeable
        )


def test_a_share_holds_plain_values():
    node = network_of(ConsensusConfig(), POSITIONS)[3]
    share = node.begin(epoch_of(0, Z[0]))
    assert {type(field) for field in share} <= {int, str, bytes, tuple}
    assert {type(number) for number in share.information_vector + share.information} == {float}
    assert (len(share.information_vector), len(share.information)) == (4, 10)
    assert share[:5] == (0, 1, 0, 0, 3)
    assert (share.scheme, share.degree, ids_of(int.from_bytes(share.live, 'little'))) == (
        'icf',
        len(node.neighbours),
        (3,),
    )


@given(st.sets(st.integers(0, 65535), max_size=20))
@properties
def test_a_bitmap_is_the_set_of_its_ids(ids):
    data = to_bytes(bitmap(ids))
    assert {8 * at + bit for at, byte in enumerate(data) for bit in range(8) if byte >> bit & 1} == ids
    assert set(ids_of(int.from_bytes(data, 'little'))) == ids


# --- what a node does with what it hears


def pair(config=None):
    """Two neighbours."""
    nodes = network_of(config or ConsensusConfig(rounds=2), np.array([[0.0, 0.0, 0.0], [60.0, 0.0, 0.0]]))
    return nodes[1], nodes[2]


def reading(k):
    return epoch_of(k, np.array([[70.0, 0.8], [50.0, 1.7]]))


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
    node, other = pair(ConsensusConfig(rounds=2))
    alone, _ = pair(ConsensusConfig(rounds=0))
    assert alone.begin(reading(0)) is None
    share = other.begin(reading(0))
    node.begin(reading(0))
    node.take(share._replace(information=tuple(-1e6 * x for x in share.information)))
    node.advance()
    node.advance()
    assert node.finish().mean == pytest.approx(alone.finish().mean, abs=1e-9)
    assert np.isnan(node.disagreement)


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


# --- life and death


def test_a_neighbour_silent_for_three_epochs_no_longer_counts_and_may_come_back():
    """Node 2 is killed after epoch 2 and started anew, with nothing but the prior, in epoch 8."""
    config = ConsensusConfig(rounds=14)
    nodes = network_of(config, POSITIONS)
    witness = nodes[2].neighbours[0]
    counted, alive = [], []
    for k in range(12):
        if k == 8:
            nodes[2] = network_of(config, POSITIONS)[2]
        estimates = run_epoch(nodes, epochs(k, [i for i in IDS if i != 2 or k < 3 or k >= 8]))
        counted.append(2 in nodes[witness].inbox.active)
        alive.append(2 in estimates[witness].contributors)
    assert counted == [True] * 6 + [False] * 3 + [True] * 3
    assert alive == [True] * 3 + [False] * 6 + [True] * 3


def test_a_restarted_node_is_back_within_three_epochs():
    nodes, reference = (
        network_of(ConsensusConfig(rounds=14), POSITIONS),
        network_of(ConsensusConfig(rounds=14), POSITIONS),
    )
    for k in range(12):
        if k == 8:
            nodes[5] = network_of(ConsensusConfig(rounds=14), POSITIONS)[5]
        ours = run_epoch(nodes, epochs(k, [i for i in IDS if i != 5 or k not in (6, 7)]))
        whole = run_epoch(reference, epochs(k))
    assert np.hypot(*(ours[5].mean - whole[5].mean)[:2]) < 0.2
    assert ours[5].contributors == tuple(IDS)


def test_halves_that_part_count_themselves_and_meet_again():
    config = ConsensusConfig(rounds=14, link=FAULTS['cut'])
    nodes = network_of(config, POSITIONS)
    left = {i for i in IDS if POSITIONS[i - 1, 0] < 95.0}
    for k in range(12):
        estimates = run_epoch(nodes, epochs(k))
        for i, estimate in estimates.items():
            side = left if i in left else set(IDS) - left
            assert set(estimate.contributors) <= (side if 3 <= k < 8 else set(IDS))
    assert all(e.contributors == tuple(IDS) for e in estimates.values())
    means = np.array([e.mean for e in estimates.values()])
    assert np.ptp(means[:, :2], axis=0).max() < 0.5
    assert sum(node.counters['cut_share'] for node in nodes.values()) > 0


def test_nodes_that_agree_say_so():
    few, many = (network_of(ConsensusConfig(rounds=L), POSITIONS) for L in (2, 40))
    for nodes in (few, many):
        run_epoch(nodes, epochs(0))
    assert max(node.disagreement for node in many.values()) < 0.2 * max(node.disagreement for node in few.values())


def test_a_reset_node_is_a_new_one():
    nodes, anew = network_of(ConsensusConfig(rounds=4), POSITIONS), network_of(ConsensusConfig(rounds=4), POSITIONS)
    for k in range(3):
        run_epoch(nodes, epochs(k))
    for node in nodes.values():
        node.reset()
    first, second = run_epoch(nodes, epochs(0)), run_epoch(anew, epochs(0))
    assert all(np.array_equal(first[i].mean, second[i].mean) for i in IDS)


# --- recordings


def test_a_recording_is_tracked_without_middleware():
    recording = record(b_field(SMALL), 3)
    config = ConsensusConfig(scheme='flood', rounds=6)
    run = run_consensus(recording, config)
    assert (run.epochs, sorted(run.estimates)) == (12, sorted(f'consensus_{i}' for i in IDS))
    assert run.dropped == {}
    last = run.estimates['consensus_4'][-1]
    assert np.hypot(*(last.mean[:2] - recording.truth[1].positions[-1, :2])) < 1.0
    again = run_consensus(recording, config)
    assert all(
        np.array_equal(a.mean, b.mean)
        for a, b in zip(run.estimates['consensus_4'], again.estimates['consensus_4'], strict=True)
    )
    dying = run_consensus(recording, config, dead={4: 5})
    assert [len(dying.estimates[f'consensus_{i}']) for i in (3, 4)] == [12, 5]
    assert dying.dropped['missing_share'] > 0


def test_a_looped_recording_starts_anew():
    recording = record(b_field(SMALL), 3)
    looped = recording._replace(
        messages=(*recording.messages[:-1], recording.messages[-1]._replace(final=False), *recording.messages)
    )
    run = run_consensus(looped, ConsensusConfig(rounds=3))
    estimates = run.estimates['consensus_1']
    assert run.epochs == 24
    assert np.array_equal(estimates[0].mean, estimates[12].mean)


def test_a_configuration_that_contradicts_itself_is_refused():
    with pytest.raises(TrackingError, match='take four numbers'):
        ConsensusConfig(prior=PriorConfig(mean=(1.0, 2.0))).checked()
    with pytest.raises(TrackingError, match=r'before `link\.cut_from`'):
        ConsensusConfig(link=LinkConfig(cut_from=3, cut_until=2)).checked()


# --- what is read


ANCHOR = make_anchors([7], [[1.0, 2.0, 0.0]], bias=0.5, scale=2.0)
DEFAULT = noise_of(ConsensusConfig())


def read(packet):
    return observation_of(Epoch(1, 0, 0, (packet,)), ANCHOR, DEFAULT)


def test_a_reading_is_freed_of_its_radios_bias_and_scale():
    z, noise = read(RangeBearing(0, 7, 1, 0, 0, 20.5, 0.3, (4.0, 0.2, 0.2, 0.09)))
    assert z.tolist() == [10.0, 0.3]
    assert noise == pytest.approx(np.array([[1.0, 0.1], [0.1, 0.09]]))
    z, noise = read(Range(0, 7, 1, 0, 0, 2, 20.5, 4.0))
    assert (z[0], np.isnan(z[1]), noise[0, 0]) == (10.0, True, 1.0)
    assert read(Range(0, 7, 1, 0, 0, 2, 20.5)).R[0, 0] == pytest.approx(0.01 / 4.0)


def test_a_signal_strength_is_a_range_with_the_noise_of_its_channel():
    z, noise = read(Rssi(0, 7, 1, 0, 0, -75.0))
    assert z[0] == pytest.approx(10.0)
    assert np.sqrt(noise[0, 0]) == pytest.approx(10.0 * 1.56 * np.log(10) / 30.0)
    assert read(Rssi(0, 7, 1, 0, 0, -75.0, sigma_db=3.12)).R[0, 0] == pytest.approx(4.0 * noise[0, 0])


@pytest.mark.parametrize(
    'packet',
    [
        RangeBearing(0, 7, 1, 0, 0, 5.0, 0.3, (1.0, 0.0, 0.0, 1.0), arrived=False),
        RangeBearing(0, 7, 1, 0, 0, float('nan'), float('inf'), (1.0, 0.0, 0.0, 1.0)),
        RangeBearing(0, 8, 1, 0, 0, 5.0, 0.3, (1.0, 0.0, 0.0, 1.0)),
        Range(0, 7, 1, 0, 0, 2, -3.0, 4.0),
    ],
)
def test_what_did_not_arrive_is_nan(packet):
    assert np.isnan(read(packet).z).all()


@pytest.mark.parametrize(
    'told', [(float('nan'),) * 4, (1.0, 2.0, 2.0, 1.0), (-1.0, 0.0, 0.0, 1.0), (1.0, 0.1, 0.2, 1.0)]
)
def test_noise_that_is_no_covariance_is_the_default(told):
    noise = read(RangeBearing(0, 7, 1, 0, 0, 5.0, 0.3, told)).R
    assert noise == pytest.approx(DEFAULT * [[0.25, 0.5], [0.5, 1.0]])
