"""The walk, the field and the recording of scenario L."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, H, properties

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.radio import MIN_RANGE, range_at
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.paths import polygon_loop
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.simulation.world import noisy_ranges, rssi_of_epoch

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
