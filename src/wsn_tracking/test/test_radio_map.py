"""The radio map against a dense Gaussian process by the textbook, and how it behaves where nobody measured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import constant_noise, mapped_noise, mapped_rssi_function, rssi_function
from wsn_tracking.models.radio_map import aligned, make_map, residual, residual_mean, residual_std

AMPLITUDE, LENGTH = 3.0, 2.5
NODES = [2, 5, 9]


def correlation(a, b):
    r = np.sqrt(3.0) * np.linalg.norm(a[:, None, :2] - b[None, :, :2], axis=-1) / LENGTH
    return (1.0 + r) * np.exp(-r)


def surveyed(seed=0, places=30):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 8.0, (places, 2))
    y = np.linalg.cholesky(correlation(points, points) + 1e-9 * np.eye(places)) @ rng.normal(0, AMPLITUDE, (places, 3))
    noise = rng.uniform(1.0, 2.5, y.shape)
    y = y + rng.normal(0.0, noise)
    y[::7, 1] = np.nan
    return points, y, noise


def mapped(points, y, noise):
    return make_map(NODES, -50.0, [2.0, 2.5, 3.0], points, y, noise, AMPLITUDE, LENGTH, 1.0, [3.0, 4.0, 5.0])


def textbook(points, y, noise, x):
    """Mean and standard deviation, Rasmussen and Williams eq. 2.25 and 2.26, node by node and without any trick."""
    mean, std = np.empty((len(x), 3)), np.empty((len(x), 3))
    for k in range(3):
        there = np.isfinite(y[:, k])
        K = AMPLITUDE**2 * correlation(points[there], points[there]) + np.diag(noise[there, k] ** 2)
        c = AMPLITUDE**2 * correlation(x, points[there])
        mean[:, k] = c @ np.linalg.inv(K) @ y[there, k]
        std[:, k] = np.sqrt(AMPLITUDE**2 - np.diag(c @ np.linalg.inv(K) @ c.T))
    return mean, std


@settings(max_examples=20)
@given(seed=st.integers(0, 10_000))
def test_the_map_is_the_gaussian_process_of_the_textbook(seed):
    points, y, noise = surveyed(seed)
    radio_map = mapped(points, y, noise)
    x = np.random.default_rng(seed + 1).uniform(-3.0, 11.0, (50, 4))
    mean, std = residual(radio_map, x)
    wanted_mean, wanted_std = textbook(points, y, noise, x)
    np.testing.assert_allclose(mean, wanted_mean, atol=1e-9)
    np.testing.assert_allclose(std, wanted_std, atol=0.08 * AMPLITUDE)  # interpolated


def test_the_deviation_is_exact_on_the_lattice():
    points, y, noise = surveyed()
    radio_map = mapped(points, y, noise)
    origin, step, std = radio_map.lattice
    i, j = np.meshgrid(np.arange(std.shape[0]), np.arange(std.shape[1]), indexing='ij')
    x = origin + step * np.stack([i, j], axis=-1).reshape(-1, 2)
    wanted = textbook(points, y, noise, x)[1]
    np.testing.assert_allclose(residual_std(radio_map, x), wanted, atol=1e-6)


def test_what_was_measured_well_comes_back():
    points, y, _ = surveyed()
    radio_map = mapped(points, np.nan_to_num(y), np.full(y.shape, 1e-3))
    np.testing.assert_allclose(residual_mean(radio_map, points), np.nan_to_num(y), atol=0.05)


def test_the_map_knows_less_the_further_it_is_from_the_survey():
    radio_map = mapped(*surveyed())
    x = np.stack([8.0 + np.arange(0.0, 40.0, 0.5), np.full(80, 4.0)], axis=-1)
    mean, std = residual(radio_map, x)
    assert np.all(np.diff(std, axis=0) > -0.02)
    assert np.all(std[0] < 0.8 * AMPLITUDE)
    np.testing.assert_allclose(std[-1], AMPLITUDE, rtol=0.03)
    np.testing.assert_allclose(mean[-1], 0.0, atol=1e-6)


def test_a_node_that_nobody_heard_keeps_its_path_loss():
    points, y, noise = surveyed()
    y[:, 2] = np.nan
    mean, std = residual(mapped(points, y, noise), points)
    assert np.all(mean[:, 2] == 0.0)
    np.testing.assert_allclose(std[:, 2], AMPLITUDE)
    assert np.all(std[:, 0] < AMPLITUDE)


def test_the_mean_has_a_derivative_everywhere():
    points, y, noise = surveyed()
    radio_map = mapped(points, y, noise)
    h = 1e-5
    for point in points[:5]:  # where the covariance is roughest
        before, at, after = residual_mean(radio_map, point + np.array([[-h, 0.0], [0.0, 0.0], [h, 0.0]]))
        np.testing.assert_allclose((after - at) / h, (at - before) / h, atol=1e-2)


@pytest.mark.parametrize('shape', [(4,), (7, 4), (3, 8, 4), (0, 4)])
def test_states_of_any_shape_are_batches_of_single_ones(shape):
    radio_map = mapped(*surveyed())
    x = np.random.default_rng(3).uniform(0.0, 8.0, shape)
    mean, std = residual(radio_map, x)
    assert mean.shape == std.shape == (*shape[:-1], 3)
    for at in np.ndindex(shape[:-1]):
        np.testing.assert_allclose(mean[at], residual_mean(radio_map, x[at]), rtol=1e-12)
        np.testing.assert_allclose(std[at], residual_std(radio_map, x[at]), rtol=1e-12)


def test_columns_follow_the_anchors():
    radio_map = mapped(*surveyed())
    anchors = make_anchors([1, 5, 9], [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]], p1_dbm=-40.0, d0=2.0, sigma_db=6.0)
    own = aligned(radio_map, anchors)
    x = np.random.default_rng(4).uniform(0.0, 8.0, (20, 4))
    mean, std = residual(radio_map, x)
    own_mean, own_std = residual(own, x)
    np.testing.assert_array_equal(own_mean[:, 1:], mean[:, 1:])
    np.testing.assert_array_equal(own_std[:, 1:], std[:, 1:])
    # node 1 is not in the map: the radio of the anchors, and nothing of a neighbour's column
    np.testing.assert_array_equal(own_mean[:, 0], 0.0)
    np.testing.assert_allclose(mapped_rssi_function(anchors, own)(x)[:, 0], rssi_function(anchors)(x)[:, 0], rtol=1e-12)
    np.testing.assert_allclose(mapped_noise(own, own.packet_db)(x)[:, 0], 6.0)


def test_signal_strengths_are_path_loss_plus_map_and_all_its_doubts():
    radio_map = mapped(*surveyed())
    anchors = make_anchors(NODES, [[0.0, 0.0, 2.0], [8.0, 0.0, 2.0], [0.0, 8.0, 2.0]], p1_dbm=-99.0, n=1.0)
    own = anchors._replace(p1_dbm=radio_map.p1_dbm, n=radio_map.n)
    x = np.random.default_rng(5).uniform(0.0, 8.0, (6, 4))
    mean, std = residual(radio_map, x)
    expected = rssi_function(own, 1.0)(x) + mean  # the map's own path loss, not the anchors'
    np.testing.assert_allclose(mapped_rssi_function(anchors, radio_map, 1.0)(x), expected)
    root = mapped_noise(radio_map, radio_map.packet_db)(x)
    np.testing.assert_allclose(root**2, std**2 + 1.0 + np.array([3.0, 4.0, 5.0]) ** 2)
    assert np.all(root > constant_noise(radio_map.packet_db)(x))
