"""Tracker objects that hear each other by shares alone equal the batched form of system B."""

import numpy as np
import pytest
from consensus_cases import R, epoch_of, network_of
from consensus_field import FAULTS, POSITIONS, SCHEMES, SMALL, Z

from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies.consensus_runs import sample
from wsn_tracking.trackers.consensus import Network
from wsn_tracking.trackers.consensus_config import ConsensusConfig, LinkConfig
from wsn_tracking.trackers.consensus_network import run_epoch


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
