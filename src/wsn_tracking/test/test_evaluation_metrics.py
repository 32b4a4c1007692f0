import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from wsn_tracking.evaluation import metrics

lengths = st.floats(-50.0, 50.0, allow_nan=False, width=64)
errors_of_runs = arrays(np.float64, st.tuples(st.integers(1, 3), st.integers(1, 12), st.just(2)), elements=lengths)

HAND = np.array([[3.0, -4.0], [0.0, 0.0], [-1.0, 0.0], [0.0, 2.0]])  # distances 5, 0, 1, 2


def test_metrics_are_those_computed_by_hand():
    assert metrics.rmse(HAND) == pytest.approx(np.sqrt((25 + 0 + 1 + 4) / 4))
    assert metrics.percentile(HAND, 50.0) == 1.5
    assert metrics.percentile(HAND, 95.0) == pytest.approx(2.0 + 0.85 * 3.0)
    assert metrics.ei(HAND) == (7 + 0 + 1 + 2) / 4
    np.testing.assert_array_equal(metrics.esi(HAND), [[3, 4], [3, 4], [4, 4], [4, 6]])


def test_position_errors_take_the_plane_of_any_state():
    means = np.array([[1.0, 2.0, 9.0, 9.0, 9.0]])
    np.testing.assert_array_equal(metrics.position_errors(means, np.array([[0.5, 3.0, 7.0]])), [[0.5, -1.0]])


def test_missing_epochs_are_left_out():
    holed = np.insert(HAND, [0, 2, 4], np.nan, axis=0)
    assert metrics.rmse(holed) == metrics.rmse(HAND)
    assert metrics.ei(holed) == metrics.ei(HAND)
    for percent in (0.0, 37.0, 50.0, 95.0, 100.0):
        assert metrics.percentile(holed, percent) == metrics.percentile(HAND, percent)
    np.testing.assert_array_equal(metrics.esi(holed)[-1], metrics.esi(HAND)[-1])


@pytest.mark.parametrize('nothing', [np.zeros((0, 2)), np.full((3, 2), np.nan)])
def test_the_mean_of_nothing_is_nan(nothing):
    assert np.isnan(metrics.rmse(nothing))
    assert np.isnan(metrics.ei(nothing))
    assert np.isnan(metrics.percentile(nothing, 50.0))


@given(errors_of_runs)
def test_batched_metrics_equal_the_loop_over_runs(errors):
    covariances = np.broadcast_to(np.array([[2.0, 0.5], [0.5, 1.0]]), (*errors.shape, 2))
    for one in (metrics.rmse, metrics.ei, metrics.esi, lambda e: metrics.percentile(e, 95.0)):
        np.testing.assert_array_equal(one(errors), np.stack([one(run) for run in errors]))
    np.testing.assert_array_equal(
        metrics.nees(errors, covariances),
        np.stack([metrics.nees(e, p) for e, p in zip(errors, covariances, strict=True)]),
    )


@given(errors_of_runs)
def test_percentile_is_that_of_numpy(errors):
    distance = np.hypot(errors[..., 0], errors[..., 1])
    for percent in (0.0, 50.0, 95.0, 100.0):
        expected = np.percentile(distance, percent, axis=-1)
        np.testing.assert_allclose(metrics.percentile(errors, percent), expected, rtol=1e-12, atol=1e-12)


@given(errors_of_runs)
def test_ei_lies_between_the_mean_distance_and_root_two_rmse(errors):
    mean_distance = np.mean(metrics.distances(errors), axis=-1)
    ei, slack = metrics.ei(errors), 1e-9
    assert np.all(mean_distance <= ei + slack)
    assert np.all(ei <= np.sqrt(2.0) * mean_distance + slack)
    assert np.all(mean_distance <= metrics.rmse(errors) + slack)


@given(errors_of_runs)
def test_esi_never_falls_and_ends_at_the_epochs_times_ei(errors):
    esi = metrics.esi(errors)
    assert np.all(np.diff(esi, axis=-2) >= 0.0)
    np.testing.assert_allclose(esi[..., -1, :].sum(axis=-1), errors.shape[-2] * metrics.ei(errors), atol=1e-9)


@pytest.mark.parametrize('d', [1, 2, 4])
def test_nees_is_the_dense_quadratic_form(d):
    rng = np.random.default_rng(d)
    root = rng.standard_normal((5, 3, d, d + 1))
    covariances = root @ np.swapaxes(root, -1, -2)
    errors = rng.standard_normal((5, 3, d))
    solved = np.linalg.solve(covariances, errors[..., None])[..., 0]
    np.testing.assert_allclose(metrics.nees(errors, covariances), np.sum(errors * solved, axis=-1), rtol=1e-9)


def test_one_bad_covariance_spoils_only_its_own_nees():
    good = np.eye(2)
    singular = np.array([[1.0, 1.0], [1.0, 1.0]])
    nearly = np.array([[0.01, 0.01 * (1 - 1e-16)], [0.01, 0.01]])
    indefinite = np.array([[1.0, 2.0], [2.0, 1.0]])
    zero = np.zeros((2, 2))
    unknown = np.full((2, 2), np.nan)
    batch = np.stack([good, singular, nearly, indefinite, zero, unknown, -good, 4.0 * good])
    values = metrics.nees(np.array([3.0, 4.0]), batch)
    assert values[0] == 25.0
    assert values[-1] == 6.25
    assert np.all(np.isnan(values[1:-1]))


@given(st.floats(1e-6, 1e6), st.floats(-0.999, 0.999))
def test_nees_does_not_depend_on_the_unit_of_length(scale, correlation):
    e, p = np.array([0.3, -0.2]), np.array([[1.0, correlation], [correlation, 1.0]])
    assert metrics.nees(scale * e, scale**2 * p) == pytest.approx(float(metrics.nees(e, p)), rel=1e-9)
