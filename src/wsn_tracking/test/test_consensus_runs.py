"""What algorithms of seed 002 must show, over the same runs for all: orderings and ratios, not absolute errors."""

from dataclasses import replace

import numpy as np
import pytest
from consensus_cases import dense_centralised

from wsn_tracking.filters.belief import Belief
from wsn_tracking.fusion import consensus
from wsn_tracking.fusion.weights import contraction, metropolis
from wsn_tracking.models.graph import adjacency, component_sizes, degrees, diameter
from wsn_tracking.simulation import b_field
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_parts import at
from wsn_tracking.studies.consensus_raw import track_raw
from wsn_tracking.studies.consensus_runs import mean_nees, mode_accuracy, rmse, sample, some, traffic
from wsn_tracking.studies.consensus_schemes import chebyshev_at_its_guard
from wsn_tracking.trackers import consensus as tracker
from wsn_tracking.trackers.consensus import Network
from wsn_tracking.trackers.consensus_config import (
    ArrivalConfig,
    ConsensusConfig,
    LinkConfig,
    ObservationConfig,
    PriorConfig,
)

RUNS, SEED = 15, 2
CM = ConsensusConfig(scheme='cm')
FLOOD = ConsensusConfig(scheme='flood')


@pytest.fixture(scope='module')
def worlds():
    return sample(FieldConfig(), RUNS, SEED)


@pytest.fixture(scope='module')
def track(worlds):
    """Scores of a configuration, each computed once."""
    kept = {}

    def scores(config):
        if config not in kept:
            kept[config] = runs_of.track(config, worlds)
        return kept[config]

    return scores


@pytest.fixture(scope='module')
def centralised(track):
    return track(replace(FLOOD, rounds=49))


# --- against the dense oracle


def test_a_complete_flood_is_the_centralised_filter(worlds, track, centralised):
    enough = diameter(adjacency(worlds.positions, 100.0))
    after = track(replace(FLOOD, rounds=enough))
    assert np.sqrt(after.squares) == pytest.approx(np.sqrt(centralised.squares), abs=1e-6)
    start = np.array([50.0, 50.0, 10.0, 10.0]), np.diag([100.0, 100.0, 9.0, 9.0])
    m, P = dense_centralised(worlds.positions[0], worlds.z[0, :12], *start, 1.0)
    network = Network(replace(FLOOD, rounds=enough), worlds.positions[0])
    nodes = network.start()
    for k in range(12):
        nodes, _ = network.step(nodes, k, 1.0 if k else 0.0, worlds.z[0, k], worlds.R)
        assert nodes.belief.m == pytest.approx(np.broadcast_to(m[k], (50, 4)), abs=1e-6)
        assert pytest.approx(np.broadcast_to(P[k], (50, 4, 4)), abs=1e-6) == nodes.belief.P


# --- accuracy


def test_without_the_loss_model_faults_ruin_the_track(track):
    single = track(replace(CM, arrival=ArrivalConfig(loss='absent')))
    assert rmse(single) >= 100.0 * rmse(track(CM))


def test_without_consensus_a_node_is_lost(track):
    assert rmse(track(replace(CM, rounds=0))) >= 20.0 * rmse(track(CM))


def test_more_rounds_come_closer_to_the_centralised_filter(track, centralised):
    of_centralised = [rmse(track(replace(CM, rounds=L))) / rmse(centralised) for L in (5, 10, 20, 40, 100)]
    assert np.all(np.diff(of_centralised) < 0.0)
    assert of_centralised[2] <= 1.35
    assert 0.99 <= of_centralised[4] <= 1.05


def test_icf_is_as_good_as_the_document_and_hcmci_is_not(track):
    assert rmse(track(ConsensusConfig())) == pytest.approx(rmse(track(CM)), rel=0.02)
    assert rmse(track(ConsensusConfig(scheme='hcmci'))) > 1.5 * rmse(track(CM))


def test_five_hops_of_a_flood_beat_twenty_rounds_at_half_the_bytes(worlds, track):
    flood = replace(FLOOD, rounds=5)
    assert rmse(track(flood)) <= rmse(track(CM))
    ours, documents = traffic(flood, worlds.positions), traffic(CM, worlds.positions)
    assert ours.bytes_nominal <= 0.4 * documents.bytes_nominal
    assert (ours.messages, documents.messages) == (5, 20)
    assert documents.bytes_nominal == 20 * 64


def test_ten_bytes_an_item_are_enough(worlds):
    """What was read, as it is sent, is worth as much as the information that was made of it."""
    few = some(worlds, slice(0, 3))
    info = runs_of.track(replace(FLOOD, rounds=5), few)
    raw = track_raw(replace(FLOOD, rounds=5), few)
    assert rmse(raw) == pytest.approx(rmse(info), rel=0.01)
    assert mean_nees(raw) == pytest.approx(mean_nees(info), rel=0.02)
    whole = replace(FLOOD, rounds=49)
    exact = track_raw(whole, some(worlds, slice(0, 1)), ten_bytes=False)
    assert np.sqrt(exact.squares) == pytest.approx(
        np.sqrt(runs_of.track(whole, some(worlds, slice(0, 1))).squares), abs=1e-6
    )


def test_chebyshev_at_its_guard_beats_twenty_rounds(worlds):
    graph = adjacency(worlds.positions, 100.0)
    tame = some(worlds, contraction(metropolis(graph, degrees(graph))) <= 0.977)
    assert len(tame.positions) >= 10
    row = chebyshev_at_its_guard(tame)
    assert row['rmse_m'] <= rmse(runs_of.track(CM, tame))
    assert row['messages'] < 16


def test_leaving_the_linearisation_error_out_claims_too_much(track):
    printed = track(replace(CM, rounds=0, observation=ObservationConfig(printed_form=True)))
    assert mean_nees(printed) > mean_nees(track(replace(CM, rounds=0)))


# --- consistency: NEES of four states


def test_no_scheme_claims_much_more_than_it_knows(track, centralised):
    assert 3.5 <= mean_nees(centralised) <= 4.6
    assert mean_nees(track(CM)) <= 5.5
    assert mean_nees(track(ConsensusConfig())) <= 5.5
    assert mean_nees(track(ConsensusConfig(scheme='hcmci'))) < 3.0


@pytest.mark.parametrize('hops', [1, 2, 3, 4, 5, 7])
def test_a_flood_is_consistent_at_every_hop_count(track, hops):
    assert 3.5 <= mean_nees(track(replace(FLOOD, rounds=hops))) <= 4.6


def test_in_a_network_that_falls_apart_only_the_live_count_is_consistent(worlds, track, monkeypatch):
    """Over all nodes, lone ones included, and where components have five nodes or more."""
    small = replace(CM, rounds=100, radius=50.0)
    size = component_sizes(adjacency(worlds.positions, 50.0))
    several = (size >= 5) & (size < 50)
    assert np.mean(several) > 0.4
    live = track(small)
    everybody = consensus.SCHEMES['cm']._replace(finish=lambda prior, average, before, after: prior + 50.0 * average)
    monkeypatch.setattr(tracker, 'SCHEMES', {**consensus.SCHEMES, 'cm': everybody})
    counted = runs_of.track(small, worlds)
    for nodes in (size > 0, several):
        assert 3.5 <= mean_nees(at(live, nodes)) <= 5.0
        assert mean_nees(at(counted, nodes)) >= 2.0 * mean_nees(at(live, nodes))


def test_a_linearisation_error_that_lasts_is_not_averaged_away(track):
    """Lone nodes: the arc that a range leaves errs to the same side epoch after epoch. Among many, nothing changes."""
    alone, new = replace(CM, rounds=0), ObservationConfig(linearisation_epochs=1.0)
    assert 2.0 * mean_nees(track(alone)) <= mean_nees(track(replace(alone, observation=new)))
    assert rmse(track(alone)) <= rmse(track(replace(alone, observation=new)))
    assert rmse(track(CM)) == rmse(track(replace(CM, observation=new)))


def test_the_more_nodes_look_the_sooner_a_linearisation_error_is_a_new_one():
    live = np.array([1.0, 2.0, 8.0, 50.0])
    assert ObservationConfig(linearisation_epochs=8.0).omega_weight(live).tolist() == [8.0, 4.0, 1.0, 1.0]
    assert ObservationConfig(linearisation_epochs=1.0).omega_weight(live).tolist() == [1.0] * 4
    assert ObservationConfig(printed_form=True).omega_weight(live) == 0.0


def test_a_node_east_of_the_target_stays_consistent(worlds):
    """All nodes see the target near bearing +-pi: the seam of the arctangent."""
    positions = worlds.positions[:, :10] * [0.1, 0.1, 1.0] + [400.0, 40.0, 0.0]
    config = FieldConfig(
        nodes=10, spectral_density=0.01, mean=(50.0, 50.0, 0.0, 0.0), std=(5.0, 5.0, 0.3, 0.3), epochs=30
    )
    rng = np.random.default_rng(5)
    states = b_field.walks(config, RUNS, rng)
    arrived = b_field.arrivals(config, rng.random((RUNS, 30, 10)))
    readings = b_field.read(config, positions[:, None], states, arrived, b_field.draw(rng, arrived.shape))
    bearing = readings.z[..., 1][arrived]
    assert np.mean(bearing > 0) == pytest.approx(0.5, abs=0.15)
    assert np.mean(np.abs(bearing) > np.pi - 1.0) > 0.9
    seam = runs_of.Worlds(positions, states, readings.z, arrived, worlds.R)
    prior = PriorConfig(mean=config.mean, std=config.std)
    scores = runs_of.track(ConsensusConfig(spectral_density=0.01, prior=prior), seam)
    assert 3.0 <= mean_nees(scores) <= 5.5
    assert rmse(scores) < 5.0


# --- modes


def test_nodes_know_whether_their_reading_was_one(worlds, track):
    assert mode_accuracy(track(CM)) >= 0.999
    assert mode_accuracy(track(replace(CM, arrival=ArrivalConfig(loss='zero')))) >= 0.999
    clutter = sample(FieldConfig(faults='clutter'), RUNS, SEED)
    scores = runs_of.track(CM, clutter)
    assert mode_accuracy(scores) >= 0.995
    assert rmse(scores) <= 1.2 * rmse(track(CM))


def test_the_documents_loss_model_takes_clutter_for_the_target():
    clutter = sample(FieldConfig(faults='clutter'), 5, SEED)
    zero = replace(CM, arrival=ArrivalConfig(loss='zero'))
    assert rmse(runs_of.track(zero, clutter)) > 100.0 * rmse(runs_of.track(CM, clutter))


def test_absent_readings_are_known_to_be_absent(track):
    absent = sample(FieldConfig(faults='absent'), RUNS, SEED)
    scores = runs_of.track(replace(CM, arrival=ArrivalConfig(loss='absent')), absent)
    assert mode_accuracy(scores) == 1.0
    assert mode_accuracy(runs_of.track(CM, absent)) >= 0.999
    assert rmse(scores) == pytest.approx(rmse(track(CM)), rel=0.02)


# --- a network that suffers


@pytest.mark.parametrize('scheme', ['cm', 'icf', 'flood'])
def test_lost_shares_cost_little(track, scheme):
    base = ConsensusConfig(scheme=scheme)
    ratios = [rmse(track(replace(base, link=LinkConfig(loss=loss)))) / rmse(track(base)) for loss in (0.3, 0.5)]
    assert ratios[0] <= 1.3
    assert ratios[1] <= 1.6


def test_chebyshev_under_loss_is_as_good_as_plain_rounds(worlds, track):
    graph = adjacency(worlds.positions, 100.0)
    tame = some(worlds, contraction(metropolis(graph, degrees(graph))) <= 0.977)
    lossy = LinkConfig(loss=0.3)
    accelerated = runs_of.track(ConsensusConfig(scheme='chebyshev', link=lossy), tame)
    assert rmse(accelerated) <= 1.05 * rmse(runs_of.track(ConsensusConfig(link=lossy), tame))
    assert mean_nees(accelerated) <= 5.5


@pytest.mark.parametrize('scheme', ['cm', 'icf', 'flood'])
def test_the_survivors_of_a_death_go_on(worlds, track, scheme):
    """In all fields, parted or not, whoever is still with most of the others; a few cut off know less, as they must."""
    config, alive = ConsensusConfig(scheme=scheme), np.ones((50, 50), dtype=bool)
    alive[25:, 0] = False
    scores = runs_of.track(config, worlds, alive)
    assert np.all(np.isnan(scores.squares[:, 25:, 0]))
    together = component_sizes(adjacency(worlds.positions[:, 1:], config.radius)) > 25
    assert np.all(together.any(axis=-1))
    survivors, before = (
        np.sqrt(np.mean(s.squares[:, 25:, 1:].swapaxes(1, 2)[together])) for s in (scores, track(config))
    )
    assert survivors <= 1.1 * before


def test_two_halves_that_meet_again_agree_again(worlds, track):
    cut = LinkConfig(cut_at=175.0, cut_from=15, cut_until=30)
    scores = runs_of.track(ConsensusConfig(link=cut), worlds)
    assert mean_nees(scores) <= 5.5
    apart, together = (rmse(scores, slice(*epochs)) for epochs in ((20, 30), (33, 50)))
    assert together <= 1.1 * rmse(track(ConsensusConfig()), slice(33, None))
    assert apart > together


def test_different_priors_converge(worlds, track):
    """Each node begins somewhere else, with a covariance that admits it."""
    rng = np.random.default_rng(3)
    root = np.broadcast_to(np.diag([10.0, 10.0, 3.0, 3.0]), (RUNS, 50, 4, 4))
    prior = Belief(worlds.states[:, :1] + rng.standard_normal((RUNS, 50, 4)) * [10.0, 10.0, 3.0, 3.0], root)
    scores = runs_of.track(ConsensusConfig(), worlds, prior=prior)
    assert rmse(scores, slice(15, None)) == pytest.approx(rmse(track(ConsensusConfig()), slice(15, None)), rel=0.1)
    assert mean_nees(scores, slice(15, None)) <= 5.5
