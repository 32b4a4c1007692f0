"""The walks, the fields and the recordings of system A's scenarios."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, H, properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import plans_of, source_of
from wsn_tracking.models.radio import MIN_RANGE, range_at
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.parameters import build
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.paths import circle, headings_inside, polygon_loop
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.simulation.world import noisy_ranges, rssi_of_epoch

INSIDE = (0.2, 0.2, 3.4, 2.2)
SQUARE = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]


def test_a_loop_is_the_documents_field():
    assert LOOP.anchors.ids.tolist() == list(range(1, 13))
    assert sorted(set(LOOP.anchors.positions[:, 0].round(9).tolist())) == [0.0, 1.2, 2.4, 3.6]
    assert sorted(set(LOOP.anchors.positions[:, 1].round(9).tolist())) == [0.0, 1.2, 2.4]
    assert LOOP.truth.shape == (120, 4)
    np.testing.assert_allclose(np.hypot(LOOP.truth[:, 2], LOOP.truth[:, 3]), 0.06)
    np.testing.assert_allclose(LOOP.truth[0], [0.6, 0.6, 0.06, 0.0])
    np.testing.assert_allclose(LOOP.truth[40], [3.0, 0.6, 0.0, 0.06], atol=1e-12)
    np.testing.assert_allclose(LOOP.truth[:, :2].min(axis=0), 0.6)
    np.testing.assert_allclose(LOOP.truth[:, :2].max(axis=0), [3.0, 1.8])


def test_a_circle_turns_all_the_time_about_the_middle_of_cells_with_less_noise_than_assumed():
    s = scenario('a_circle')
    assert s.truth.shape == (100, 4)
    np.testing.assert_allclose(np.hypot(*(s.truth[:, :2] - [1.8, 1.2]).T), 0.13)
    np.testing.assert_allclose(np.hypot(*s.truth[:, 2:].T), 0.06)
    np.testing.assert_allclose(np.sum(s.truth[:, 2:] * (s.truth[:, :2] - [1.8, 1.2]), axis=1), 0.0, atol=1e-12)
    assert sorted(set(s.anchors.positions[:, 0].tolist())) == [0.45, 1.35, 2.25, 3.15]
    assert sorted(set(s.anchors.positions[:, 1].tolist())) == [0.4, 1.2, 2.0]
    error = np.array([range_at(s.anchors, rssi_of_epoch(s, k, 5)) for k in range(100)])
    error /= np.hypot(*(s.truth[:, None, :2] - s.anchors.positions[:, :2]).T).T
    assert np.std(error) == pytest.approx(0.62 * 0.12, abs=0.006)  # 1200 draws: standard error 0.0015


def test_a_heading_walks_from_the_middle_and_keeps_from_the_border():
    walks = np.stack([scenario('a_heading', seed=seed).truth for seed in range(60)])
    assert walks.shape == (60, 120, 4)
    np.testing.assert_allclose(walks[:, 0, :2], np.broadcast_to([1.8, 1.2], (60, 2)))
    np.testing.assert_allclose(np.hypot(walks[..., 2], walks[..., 3]), 0.06)
    assert walks[..., 0].min() == pytest.approx(0.2, abs=0.02)  # somebody does reach it
    assert walks[..., 0].min() >= 0.2
    assert walks[..., 0].max() <= 3.4
    assert walks[..., 1].min() >= 0.2
    assert walks[..., 1].max() <= 2.2
    turned = np.any(np.abs(np.diff(walks[..., 2:], axis=1)) > 1e-12, axis=-1)
    assert np.all(turned[:, 9::10])  # a new heading every 10 s
    assert 0.0 < turned.mean() - turned[:, 9::10].size / turned.size < 0.05  # and reflections in between
    assert np.array_equal(scenario('a_heading', seed=7).anchors.positions, LOOP.anchors.positions)


@properties
@given(st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=6), st.floats(0.01, 0.5), st.floats(0.0, 60.0))
def test_reflected_walks_stay_inside_and_move_as_their_velocity_says(headings, speed, time):
    dt = 1e-4
    now, later = headings_inside(INSIDE, headings, speed, 10.0, [time, time + dt])
    assert INSIDE[0] <= now[0] <= INSIDE[2]
    assert INSIDE[1] <= now[1] <= INSIDE[3]
    assert np.hypot(*now[2:]) == pytest.approx(speed)
    assert np.hypot(*(later[:2] - now[:2])) <= speed * dt * (1.0 + 1e-6) + 1e-12
    if np.array_equal(now[2:], later[2:]) and time + dt < 10.0 * len(headings):
        np.testing.assert_allclose(later[:2] - now[:2], now[2:] * dt, atol=1e-12)


def test_a_circle_is_closed_after_its_time_and_walked_counter_clockwise():
    around = 2.0 * np.pi * 0.5 / 0.1
    states = circle((1.0, 2.0), 0.5, 0.1, [0.0, around / 4.0, around])
    np.testing.assert_allclose(states[0], [1.5, 2.0, 0.0, 0.1], atol=1e-12)
    np.testing.assert_allclose(states[1], [1.0, 2.5, -0.1, 0.0], atol=1e-12)
    np.testing.assert_allclose(states[2], states[0], atol=1e-12)


def test_a_drawn_walk_is_the_seeds_and_no_other_walk_has_one():
    walks = [record(scenario('a_heading', seed=seed), seed).truth[1].positions for seed in (3, 3, 4)]
    np.testing.assert_array_equal(walks[0], walks[1])
    assert np.abs(walks[0] - walks[2]).max() > 0.1
    np.testing.assert_array_equal(scenario('a_circle', seed=3).truth, scenario('a_circle', seed=4).truth)


@pytest.mark.parametrize('name', ['a_loop', 'a_circle', 'a_heading'])
def test_a_scenario_is_tracked_with_its_own_trigger_and_otherwise_as_random_q(name):
    s = scenario(name)
    source = source_of(name, record(s, 1))
    (plan,), (usual,) = (plans_of(source, s.anchors, 'random_q', name) for name in ('', 'random_q'))
    built = build(SensingNodeConfig, plan.sensing).trigger
    assert built.alpha == s.alpha
    assert dataclasses.replace(built, alpha=0.0) == dataclasses.replace(
        build(SensingNodeConfig, usual.sensing).trigger, alpha=0.0
    )
    for mine, theirs in zip(plan.estimators, usual.estimators, strict=True):
        assert build(EstimatorNodeConfig, mine) == build(EstimatorNodeConfig, theirs)


def test_an_unknown_scenario_is_refused():
    with pytest.raises(TrackingError, match='there is no scenario `a_lop`: expected one of a_loop'):
        scenario('a_lop')


def test_corners_are_met_at_their_time_with_the_velocity_of_the_side_to_come():
    states = polygon_loop(SQUARE, 0.5, [0.0, 4.0, 6.0, 10.0, 12.0, 13.0])
    expected = [[0, 0, 0.5, 0], [2, 0, 0, 0.5], [2, 1, -0.5, 0], [0, 1, 0, -0.5], [0, 0, 0.5, 0], [0.5, 0, 0.5, 0]]
    np.testing.assert_allclose(states, expected, atol=1e-12)


@properties
@given(st.floats(0.01, 5.0), st.floats(0.0, 500.0), st.floats(1e-3, 0.1))
def test_a_walk_moves_with_its_speed_along_the_polygon(speed, time, dt):
    now, later = polygon_loop(SQUARE, speed, [time, time + dt])
    assert np.hypot(*now[2:]) == pytest.approx(speed)
    way = np.abs(later[:2] - now[:2]).sum()  # along the sides, which are parallel to the axes
    assert way <= speed * dt + 1e-9
    on_side = [now[0] in (0.0, 2.0) or abs(now[0] * (2.0 - now[0])) < 1e-9, abs(now[1] * (1.0 - now[1])) < 1e-9]
    assert any(on_side)
    if np.array_equal(now[2:], later[2:]):
        np.testing.assert_allclose(later[:2] - now[:2], now[2:] * dt, atol=1e-9)


def test_noise_is_a_share_of_the_distance_and_no_range_is_below_a_centimetre():
    normals = np.array([0.0, 1.0, -1.0, -9.0, *[0.5] * 8])
    z = noisy_ranges(LOOP, LOOP.truth[3], normals)
    d = H(LOOP.truth[3])
    np.testing.assert_allclose(z[[0, 1, 2, 4]], d[[0, 1, 2, 4]] * np.array([1.0, 1.12, 0.88, 1.06]))
    assert z[3] == MIN_RANGE


def test_signal_strengths_are_those_of_the_noisy_ranges():
    error = np.array([range_at(LOOP.anchors, rssi_of_epoch(LOOP, k, 5)) / H(LOOP.truth[k]) - 1.0 for k in range(120)])
    # 1440 draws: standard error of the scatter 0.0022, of the mean 0.0032
    assert np.std(error) == pytest.approx(0.12, abs=0.008)
    assert abs(np.mean(error)) < 0.012
    neighbours = [np.corrcoef(error[:, i], error[:, i + 1])[0, 1] for i in range(11)]
    assert np.max(np.abs(neighbours)) < 0.4


def test_epochs_and_seeds_have_noise_of_their_own_in_whatever_order():
    forward = [rssi_of_epoch(LOOP, k, 1).tolist() for k in range(5)]
    assert [rssi_of_epoch(LOOP, k, 1).tolist() for k in reversed(range(5))][::-1] == forward
    assert rssi_of_epoch(LOOP, 0, 2).tolist() != forward[0]


def test_a_recording_holds_a_request_all_signals_and_an_end_for_every_epoch():
    recording = record(LOOP, 3)
    again = record(LOOP, 3)
    assert recording.messages == again.messages
    assert record(LOOP, 4).messages != recording.messages
    by_kind = {kind: [m for m in recording.messages if isinstance(m, kind)] for kind in (Request, Rssi, EpochEnd)}
    assert [len(v) for v in by_kind.values()] == [120, 1440, 120]
    assert [e.final for e in by_kind[EpochEnd]] == [False] * 119 + [True]
    assert all(e.node_ids == tuple(range(1, 13)) and set(e.seqs) == {e.request_seq} for e in by_kind[EpochEnd])
    told = np.array([m.rssi_dbm for m in by_kind[Rssi]]).reshape(120, 12)
    np.testing.assert_array_equal(told[17], rssi_of_epoch(LOOP, 17, 3))
    (truth,) = recording.truth.values()
    assert np.unique(np.diff(truth.stamps_ns)).tolist() == [10**9]
    np.testing.assert_array_equal(truth.positions[:, :2], LOOP.truth[:, :2])
    np.testing.assert_array_equal(truth.velocities[:, :2], LOOP.truth[:, 2:])
    assert recording.entry_level == recording.metadata['entry_level'] == 'rssi'
    assert recording.metadata['area'] == '0 0 3.6 2.4'
