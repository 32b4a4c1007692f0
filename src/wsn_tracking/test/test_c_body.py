"""The scenarios of seed 003: where their nodes are, what these hear, and how it is recorded."""

import math
from dataclasses import replace

import numpy as np
import pytest

from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.body import LOS, NLOS, mean_rssi
from wsn_tracking.parameters import build
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.c_body import (
    BODY_SCENARIOS,
    BodyConfig,
    CircleConfig,
    CorridorConfig,
    body_scenario,
    hear,
    nodes,
)
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import PARAMETERS, scenario


def test_nodes_are_the_documents():
    assert nodes(CircleConfig()).positions[:, :2].tolist() == [[-15, -15], [15, -15], [-15, 15], [15, 15]]
    walk = nodes(BodyConfig()).positions
    assert len(walk) == 16
    assert np.unique(walk[:, 0]).tolist() == pytest.approx([0.0, 100.0 / 3.0, 200.0 / 3.0, 100.0])
    corridor = nodes(CorridorConfig()).positions
    assert np.unique(corridor[:, 0]).tolist() == [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]
    assert np.unique(corridor[:, 1]).tolist() == [0.25, 1.75]


# ---- what is heard


def heard(config, runs=4000, t=0.0, position=(40.0, 55.0), facing=0.4, seed=1):
    anchors = nodes(config)
    place = np.broadcast_to(position, (runs, 2))
    return anchors, hear(config, anchors, place, np.full(runs, facing), t, np.random.default_rng(seed))


def expected(anchors, position=(40.0, 55.0), facing=0.4):
    values = []
    for x, y, _ in anchors.positions:
        dx, dy = x - position[0], y - position[1]
        ahead = dx * math.cos(facing) + dy * math.sin(facing) > 0.0
        values.append(mean_rssi(LOS if ahead else NLOS, np.hypot(dx, dy)))
    return np.array(values), np.hypot(*(anchors.positions[:, :2] - position).T)


def test_readings_scatter_about_the_curve_of_their_side():
    anchors, z = heard(BodyConfig())
    mean, d = expected(anchors)
    near = d <= 50.0
    assert 0 < near.sum() < 16
    assert np.isnan(z[:, ~near]).all()
    np.testing.assert_allclose(z[:, near].mean(axis=0), mean[near], atol=5.0 * 3.0 / math.sqrt(4000))
    np.testing.assert_allclose(z[:, near].std(axis=0), 3.0, rtol=0.06)


def test_outliers_say_anything_and_packets_are_lost():
    anchors, z = heard(BodyConfig(reach=1e6, outliers=0.3, loss=0.2))
    mean, _ = expected(anchors)
    assert np.isnan(z).mean() == pytest.approx(0.2, abs=0.01)
    far = np.abs(z - mean) > 15.0
    inside = (np.minimum(mean + 15.0, -40.0) - np.maximum(mean - 15.0, -100.0)) / 60.0
    np.testing.assert_allclose(far.sum(axis=0) / np.sum(~np.isnan(z), axis=0), 0.3 * (1.0 - inside), atol=0.04)
    wild = z[far]
    assert wild.min() >= -100.0
    assert wild.max() <= -40.0


@pytest.mark.parametrize(
    ('t', 'silent', 'dead'), [(0.0, False, False), (10.0, True, False), (19.9, True, True), (20.0, False, True)]
)
def test_silence_and_death_have_their_time(t, silent, dead):
    config = BodyConfig(reach=1e6, silent_from=10.0, silent_until=20.0, dead=(3, 7), dead_from=15.0)
    _, z = heard(config, 1, t)
    assert np.isnan(z).all() == silent
    if not silent:
        assert np.flatnonzero(np.isnan(z[0])).tolist() == ([2, 6] if dead else [])


def test_loss_and_outliers_leave_the_other_readings_alone():
    _, clean = heard(BodyConfig())
    _, marred = heard(BodyConfig(outliers=0.1, loss=0.1))
    kept = (marred == clean) | (np.isnan(marred) & np.isnan(clean))
    assert 0.75 < kept.mean() < 0.98


# ---- recordings


@pytest.mark.parametrize('name', sorted(BODY_SCENARIOS))
def test_every_scenario_is_recorded_with_its_truth(name):
    s = scenario(name, seed=3)
    assert (s.configuration, s.entry_level, s.name) == ('human', 'rssi', name)
    recording = record(s, 3)
    truth = recording.truth[1]
    np.testing.assert_array_equal(truth.positions[:, :2], s.truth[:, :2])
    np.testing.assert_array_equal(truth.velocities[:, :2], s.truth[:, 2:])
    packets = [m for m in recording.messages if isinstance(m, Rssi)]
    assert {p.node_id for p in packets} <= set(s.anchors.ids.tolist())
    assert all(math.isfinite(p.rssi_dbm) and p.sigma_db == BODY_SCENARIOS[name]().sigma for p in packets)
    for node in {p.node_id for p in packets}:
        assert [p.seq for p in packets if p.node_id == node] == list(range(sum(p.node_id == node for p in packets)))
    again, other = record(scenario(name, seed=3), 3), record(scenario(name, seed=4), 4)
    assert again.messages == recording.messages
    assert other.messages != recording.messages


def test_the_recorded_walk_is_that_of_the_seed_and_its_settings():
    one = scenario('c_walk', {'duration': 30.0, 'sigma': 1.0}, seed=5)
    assert len(one.truth) == 61
    np.testing.assert_array_equal(one.truth, scenario('c_walk', seed=5).truth[:61])
    assert np.any(one.truth != scenario('c_walk', seed=6).truth[:61])


def test_scenarios_differ_in_defaults_alone():
    for name, kind in BODY_SCENARIOS.items():
        assert issubclass(kind, BodyConfig)
        assert PARAMETERS[name] is kind
        assert build(kind, {}) == kind()


@pytest.mark.parametrize(
    ('config', 'words'),
    [
        (BodyConfig(hot_spots=(1.0, 2.0, 3.0)), 'expected x, y of each'),
        (BodyConfig(slowest=3.0), 'below `slowest`'),
        (BodyConfig(margin=50.0), 'leaves nothing'),
        (BodyConfig(turn_after=1e-6), 'shorter than an epoch, 0.5 s'),
    ],
)
def test_settings_that_contradict_each_other_are_refused(config, words):
    with pytest.raises(TrackingError, match=words):
        body_scenario('c_walk', config, 1)


def test_one_epoch_is_a_walk_too():
    s = body_scenario('c_walk', replace(BodyConfig(), duration=0.0), 1)
    assert s.truth.shape == (1, 4)


def test_the_command_writes_a_bag_of_it(call, tmp_path):
    assert call('simulate', 'c_walk', '--seed', 1, '--set', 'duration=10', '-o', tmp_path / 'bag').code == 0
    recording = read(tmp_path / 'bag')
    assert recording.entry_level == 'rssi'
    np.testing.assert_allclose(recording.truth[1].positions[:, :2], scenario('c_walk', seed=1).truth[:21, :2])
