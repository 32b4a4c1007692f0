"""The log-distance fit: exact where the data are, calm where they are not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.calibration import EXPONENTS, fit_path_loss


def curve(distances, p1_dbm, n, d0=1.0):
    return p1_dbm - 10.0 * n * np.log10(np.asarray(distances) / d0)


@settings(max_examples=60)
@given(p1=st.floats(-90, -20), n=st.floats(0.8, 5.0), d0=st.sampled_from([0.5, 1.0, 2.0]), seed=st.integers(0, 99))
def test_exact_data_give_the_exact_curve(p1, n, d0, seed):
    d = np.random.default_rng(seed).uniform(0.5, 30.0, 20)
    fit = fit_path_loss(d, curve(d, p1, n, d0), d0=d0)
    assert fit.p1_dbm == pytest.approx(p1, abs=1e-3)
    assert fit.n == pytest.approx(n, abs=1e-4)
    assert fit.sigma_db < 1e-2
    assert fit.count == 20


def test_noise_is_measured():
    rng = np.random.default_rng(1)
    d = rng.uniform(0.5, 20.0, 4000)
    fit = fit_path_loss(d, curve(d, -55.0, 2.7) + rng.normal(0.0, 4.0, d.size))
    assert fit.n == pytest.approx(2.7, abs=0.1)
    assert fit.p1_dbm == pytest.approx(-55.0, abs=0.8)
    assert fit.sigma_db == pytest.approx(4.0, rel=0.05)


def test_a_tenth_of_outliers_moves_little():
    rng = np.random.default_rng(2)
    d = rng.uniform(0.5, 20.0, 200)
    y = curve(d, -55.0, 2.7) + rng.normal(0.0, 2.0, d.size)
    clean = fit_path_loss(d, y)
    spoiled = y.copy()
    spoiled[:20] -= 40.0
    robust = fit_path_loss(d, spoiled)
    _, intercept = np.polyfit(10.0 * np.log10(d), spoiled, 1)
    error = abs(robust.p1_dbm - clean.p1_dbm)
    assert error < 1.0
    assert error < 0.4 * abs(intercept - clean.p1_dbm)
    assert abs(robust.n - clean.n) < 0.15
    assert robust.sigma_db < 2.0 * clean.sigma_db


def test_the_noise_does_not_make_up_an_exponent():
    rng = np.random.default_rng(3)
    fits = []
    for _ in range(50):
        d = rng.uniform(4.9, 5.1, 6)  # tells nothing of n
        fits.append(fit_path_loss(d, curve(d, -55.0, 2.0) + rng.normal(0.0, 4.0, d.size)))
    assert all(abs(fit.n - 2.0) < 0.5 for fit in fits)
    assert np.mean([curve(5.0, fit.p1_dbm, fit.n) for fit in fits]) == pytest.approx(curve(5.0, -55.0, 2.0), abs=1.0)


def test_one_distance_alone_gives_the_exponent_of_free_space():
    fit = fit_path_loss([3.0, 3.0, 3.0], [-60.0, -61.0, -59.0])
    assert fit.n == pytest.approx(2.0)
    assert curve(3.0, fit.p1_dbm, fit.n) == pytest.approx(-60.0)


@pytest.mark.parametrize('n', [-3.0, 12.0])
def test_the_exponent_stays_within_bounds(n):
    d = np.geomspace(0.5, 30.0, 60)
    fit = fit_path_loss(d, curve(d, -55.0, n))
    assert fit.n in EXPONENTS
    assert fit.sigma_db > 1.0


@settings(max_examples=40)
@given(seed=st.integers(0, 999))
def test_weights_count_as_repetitions_and_order_does_not(seed):
    rng = np.random.default_rng(seed)
    d = rng.uniform(0.5, 20.0, 30)
    y = curve(d, -50.0, 2.2) + rng.normal(0.0, 1.0, d.size)
    order = rng.permutation(d.size)
    there, back = fit_path_loss(d, y), fit_path_loss(d[order], y[order])
    np.testing.assert_allclose(there, back, rtol=1e-9)
    none = np.r_[np.ones(30), np.zeros(5)]
    kept = fit_path_loss(np.r_[d, d[:5]], np.r_[y, y[:5] + 50.0], none)
    np.testing.assert_allclose(kept, there, rtol=1e-9)


def test_unusable_values_are_left_out():
    d = np.array([1.0, 2.0, 4.0, 8.0, 0.0, -1.0, np.nan, 3.0, np.inf])
    y = np.array([-50.0, -56.0, -62.0, -68.0, -40.0, -40.0, -40.0, np.nan, -99.0])
    fit = fit_path_loss(d, y)
    assert fit.count == 4
    assert fit.n == pytest.approx(2.0, abs=0.01)


def test_too_few_values_are_refused():
    with pytest.raises(TrackingError, match='2 of 3 signal strengths'):
        fit_path_loss([1.0, 2.0, np.nan], [-50.0, -56.0, -60.0])
