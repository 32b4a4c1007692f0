"""Distance and signal strength: each other's inverse, within what a radio resolves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, properties, small_anchors

from wsn_tracking.models import measurement
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.radio import MIN_RANGE, range_at, relative_range_std, rssi_at


@properties
@given(st.floats(0.02, 500.0), st.floats(1.5, 6.0), st.floats(-80.0, -20.0), st.floats(0.1, 10.0))
def test_range_and_rssi_are_each_others_inverse(distance, n, p1_dbm, d0):
    anchors = small_anchors(n=[n, 2.0, 4.0], p1_dbm=p1_dbm, d0=d0)
    d = distance * np.array([1.0, 0.5, 2.0])
    np.testing.assert_allclose(range_at(anchors, rssi_at(anchors, d)), np.maximum(d, MIN_RANGE), rtol=1e-11)


def test_the_radio_is_the_documents():
    anchors = LOOP.anchors
    assert rssi_at(anchors, np.full(12, 1.0)) == pytest.approx(-45.0)
    assert rssi_at(anchors, np.full(12, 10.0)) == pytest.approx(-75.0)
    assert range_at(anchors, np.full(12, -55.0)) == pytest.approx(10.0 ** (1.0 / 3.0))  # the service radius, 2.15 m
    assert relative_range_std(anchors) == pytest.approx(0.12, abs=5e-4)


def test_no_range_and_no_distance_is_below_the_radios_resolution():
    anchors = small_anchors()
    assert np.all(range_at(anchors, np.full(3, 200.0)) == MIN_RANGE)
    np.testing.assert_array_equal(rssi_at(anchors, np.zeros(3)), rssi_at(anchors, np.full(3, MIN_RANGE)))
    on_top = np.array([[0.0, 0.0, 0.0, 0.0]])
    assert measurement.distances(anchors, on_top, height=1.0)[0, 2] == MIN_RANGE


@pytest.mark.filterwarnings('error')
def test_no_range_is_beyond_what_can_be_squared():
    waveguide = make_anchors([1], [[0.0, 0.0]], n=0.01)
    assert np.square(np.square(range_at(waveguide, [-127.0]))) < np.inf


@properties
@given(st.floats(0.2, 6.0), st.floats(1.5, 6.0))
def test_scatter_in_decibel_is_an_even_scatter_of_the_logarithm_of_the_range(sigma_db, n):
    anchors = small_anchors(sigma_db=sigma_db, n=n)
    rssi = rssi_at(anchors, np.array([1.0, 4.0, 9.0]))
    shift = np.log(range_at(anchors, rssi - sigma_db)) - np.log(range_at(anchors, rssi))
    np.testing.assert_allclose(shift, relative_range_std(anchors), rtol=1e-9)


def test_distances_are_three_dimensional():
    anchors = small_anchors()
    states = np.array([[2.0, 3.0, 9.0, 9.0], [0.0, 0.0, 0.0, 0.0]])
    expected = np.linalg.norm(np.array([[2.0, 3.0, 0.4], [0.0, 0.0, 0.4]])[:, None] - anchors.positions, axis=-1)
    np.testing.assert_allclose(measurement.distances(anchors, states, height=0.4), expected)


def test_functions_of_a_calibrated_radio_take_its_scale_and_bias():
    anchors = small_anchors(scale=[1.1, 1.0, 0.9], bias=[0.2, 0.0, -0.1])
    x = np.random.default_rng(1).random((2, 5, 4))
    d = measurement.distances(anchors, x, 0.3)
    h = measurement.range_function(anchors, 0.3)
    np.testing.assert_allclose(h(x), anchors.scale * d + anchors.bias)
    np.testing.assert_allclose(measurement.log_range_function(anchors, 0.3)(x), np.log(h(x)))
    np.testing.assert_allclose(measurement.rssi_function(anchors, 0.3)(x), rssi_at(anchors, d))
    np.testing.assert_allclose(measurement.relative_noise(anchors, h)(x), relative_range_std(anchors) * h(x))
    assert measurement.constant_noise(np.ones((2, 3)))(x).shape == (2, 1, 3)
