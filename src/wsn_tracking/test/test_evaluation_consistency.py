import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import metrics
from wsn_tracking.evaluation.consistency import (
    chi_square_quantile,
    effective_epochs,
    nees_interval,
    pooled_epochs,
)


def autoregressive(runs, epochs, coefficient, seed):
    """Consistent unit errors (runs, epochs, 2) whose neighbours correlate by `coefficient`."""
    rng = np.random.default_rng(seed)
    errors = rng.standard_normal((runs, epochs, 2))
    for k in range(1, epochs):
        errors[:, k] = coefficient * errors[:, k - 1] + math.sqrt(1 - coefficient**2) * errors[:, k]
    return errors


def accepted(means, epochs):
    intervals = np.array([nees_interval(float(n)) for n in np.broadcast_to(epochs, means.shape)])
    return float(np.mean((means >= intervals[:, 0]) & (means <= intervals[:, 1])))


@pytest.mark.parametrize('dof', [1.0, 1.3, 2.0, 3.7, 20.0, 230.0, 1e4, 2e5])
def test_chi_square_quantile_is_that_of_scipy(dof):
    stats = pytest.importorskip('scipy.stats')
    for p in (1e-7, 1e-3, 0.025, 0.5, 0.975, 0.999999):
        assert chi_square_quantile(p, dof) == pytest.approx(float(stats.chi2.ppf(p, dof)), rel=1e-9)


@given(st.floats(1e-6, 1.0 - 1e-6))
def test_two_degrees_of_freedom_have_a_closed_form(p):
    assert chi_square_quantile(p, 2.0) == pytest.approx(-2.0 * math.log1p(-p), rel=1e-9)


@given(st.floats(1.0, 3e3), st.floats(0.01, 0.98))
def test_quantile_grows_with_the_probability_and_the_degrees_of_freedom(dof, p):
    assert chi_square_quantile(p, dof) < chi_square_quantile(p + 0.01, dof)
    assert chi_square_quantile(p, dof) < chi_square_quantile(p, dof + 0.5)


@pytest.mark.parametrize(('p', 'dof'), [(0.0, 2.0), (1.0, 2.0), (0.5, 0.5), (0.5, math.inf), (math.nan, 2.0)])
def test_a_quantile_that_does_not_exist_is_refused(p, dof):
    with pytest.raises(TrackingError, match='expected 0 < p < 1'):
        chi_square_quantile(p, dof)


def test_the_interval_is_that_of_a_table_book():
    # Fifty epochs in two dimensions: chi-square with 100 degrees of freedom lies in [74.22, 129.56].
    low, high = nees_interval(50)
    assert low == pytest.approx(74.2219 / 50, abs=1e-5)
    assert high == pytest.approx(129.5612 / 50, abs=1e-5)


@given(st.floats(1.0, 5e3), st.integers(1, 5))
def test_interval_holds_the_dimension_and_narrows_with_the_epochs(epochs, dimension):
    low, high = nees_interval(epochs, dimension)
    assert low < dimension < high
    narrow_low, narrow_high = nees_interval(2.0 * epochs, dimension)
    assert low < narrow_low < narrow_high < high


def test_no_epoch_has_no_interval():
    assert all(math.isnan(bound) for bound in nees_interval(0))
    assert all(math.isnan(bound) for bound in nees_interval(math.nan))


def test_nees_of_draws_from_the_claimed_covariance_is_accepted_as_often_as_promised():
    rng = np.random.default_rng(5)
    covariance = np.array([[0.04, 0.03], [0.03, 0.09]])
    errors = rng.standard_normal((4000, 40, 2)) @ np.linalg.cholesky(covariance).T
    means = metrics.mean_known(metrics.nees(errors, covariance))
    assert accepted(means, 40) == pytest.approx(0.95, abs=0.015)
    # A filter that claims half its variance is found out.
    assert accepted(2.0 * means, 40) < 0.05


def test_white_epochs_are_worth_about_their_number():
    values = metrics.nees(autoregressive(300, 200, 0.0, 1), np.eye(2))
    assert np.mean(effective_epochs(values)) == pytest.approx(200, rel=0.1)


def test_correlated_epochs_are_worth_what_theory_says():
    # NEES of AR(1) errors has autocorrelation a^(2k): tau = (1 + a^2) / (1 - a^2).
    values = metrics.nees(autoregressive(60, 3000, 0.9, 2), np.eye(2))
    assert np.median(effective_epochs(values)) == pytest.approx(3000 * 0.19 / 1.81, rel=0.1)


def test_effective_epochs_accept_good_filters_that_the_plain_count_rejects():
    values = metrics.nees(autoregressive(800, 115, 0.8, 3), np.eye(2))
    means = values.mean(axis=-1)
    assert accepted(means, 115) < 0.75
    assert accepted(means, effective_epochs(values)) > 0.88


def test_effective_epochs_are_batched_and_within_their_bounds():
    values = metrics.nees(autoregressive(6, 50, 0.5, 4), np.eye(2))
    values[2, 10:20] = np.nan
    worth = effective_epochs(values)
    np.testing.assert_allclose(worth, [effective_epochs(run) for run in values], rtol=1e-12)
    assert np.all(worth >= 1.0)
    assert np.all(worth <= np.sum(~np.isnan(values), axis=-1))


@pytest.mark.parametrize(
    ('series', 'worth'),
    [
        ([], 0.0),
        ([np.nan, np.nan], 0.0),
        ([3.0], 1.0),
        ([np.nan, 3.0], 1.0),
        ([2.5] * 40, 1.0),
        ([1.0, 5.0] * 20, 40.0),
        ([np.inf, np.inf], 1.0),
        ([1.0, np.inf] * 20, 40.0),
    ],
)
def test_degenerate_series_are_worth_what_they_hold(series, worth):
    assert effective_epochs(np.array(series, dtype=np.float64)) == pytest.approx(worth)


def test_pooling_equal_runs_adds_their_effective_epochs():
    assert pooled_epochs(np.full(4, 100.0), np.full(4, 25.0)) == pytest.approx(100.0)
    assert pooled_epochs(np.array([100.0, 0.0]), np.array([25.0, 0.0])) == pytest.approx(25.0)
    assert pooled_epochs(np.zeros(2), np.zeros(2)) == 0.0


@given(st.lists(st.tuples(st.integers(1, 500), st.floats(0.01, 1.0)), min_size=2, max_size=6), st.data())
def test_pooling_pools_is_pooling_all(runs, data):
    epochs = np.array([n for n, _ in runs], dtype=np.float64)
    worth = epochs * np.array([share for _, share in runs])
    cut = data.draw(st.integers(1, len(runs) - 1))
    parts = [pooled_epochs(epochs[s], worth[s]) for s in (slice(cut), slice(cut, None))]
    sizes = np.array([epochs[:cut].sum(), epochs[cut:].sum()])
    assert pooled_epochs(sizes, np.array(parts)) == pytest.approx(pooled_epochs(epochs, worth))
