"""The EKF of single ranges, its two-model form, manoeuvres and the frozen gain, against dense oracles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import covariances, properties

from wsn_tracking.filters import ekf, frozen_gain, imm, manoeuvre
from wsn_tracking.filters.ekf import Gaussian

F = np.eye(4) + 0.3 * np.eye(4, k=2)
Q = 0.01 * np.diag([1.0, 1.0, 2.0, 2.0])


def belief(seed, *shape):
    rng = np.random.default_rng(seed)
    return Gaussian(rng.uniform(-3.0, 3.0, (*shape, 4)), covariances(rng, *shape, condition=100.0))


def place(seed, *shape):
    return np.random.default_rng(seed + 1).uniform(4.0, 9.0, (*shape, 3)) * [1.0, -1.0, 0.3]


def dense_update(m, P, z, a, R):
    """The textbook: H by central differences, gain and covariance with whole matrices."""

    def h(x):
        return np.sqrt(np.sum((x[:2] - a[:2]) ** 2) + a[2] ** 2)

    H = np.array([[(h(m + e) - h(m - e)) / 2e-6 for e in 1e-6 * np.eye(4)]])
    S = H @ P @ H.T + R
    K = P @ H.T @ np.linalg.inv(S)
    return m + K[:, 0] * (z - h(m)), (np.eye(4) - K @ H) @ P, z - h(m), S[0, 0]


@properties
@given(st.integers(0, 10**6), st.floats(3.0, 12.0), st.floats(0.01, 1.0), st.floats(0.0, 0.5))
def test_one_range_is_the_textbook_update(seed, z, std, share):
    prior, a = belief(seed), place(seed)
    h = ekf.expected(prior.m, a)[0]
    m, P, nu, S = dense_update(*prior, z, a, std**2 + (share * h) ** 2)
    seen = ekf.innovation(prior, z, a, std, share)
    assert seen.nu == pytest.approx(nu)
    assert pytest.approx(S, rel=1e-6) == seen.S
    got = ekf.update(prior, seen)
    np.testing.assert_allclose(got.m, m, atol=1e-6)
    np.testing.assert_allclose(got.P, P, atol=1e-6)
    assert np.linalg.eigvalsh(got.P)[0] > 0.0


def test_a_batch_is_its_elements_and_what_was_not_heard_changes_nothing():
    prior, a = belief(3, 5, 7), place(3, 5, 7)
    z = np.random.default_rng(3).uniform(3.0, 9.0, (5, 7))
    z[::2, ::3] = np.nan
    whole = ekf.update(prior, ekf.innovation(prior, z, a, 0.1, 0.05))
    moved = ekf.predict(prior, F, Q)
    for i in np.ndindex(5, 7):
        one = Gaussian(prior.m[i], prior.P[i])
        got = ekf.update(one, ekf.innovation(one, z[i], a[i], 0.1, 0.05))
        np.testing.assert_allclose(whole.m[i], got.m, atol=1e-12)
        np.testing.assert_allclose(whole.P[i], got.P, atol=1e-12)
        np.testing.assert_allclose(moved.P[i], F @ prior.P[i] @ F.T + Q, atol=1e-12)
    np.testing.assert_array_equal(whole.m[::2, ::3], prior.m[::2, ::3])
    np.testing.assert_array_equal(whole.P[::2, ::3], prior.P[::2, ::3])


@properties
@given(st.integers(0, 10**6))
def test_josephs_form_is_true_to_any_gain(seed):
    """E (x - x_hat)(x - x_hat)' of x_hat = m + K (H (x - m) + r), drawn from its Cholesky factor exactly."""
    prior, a = belief(seed), place(seed)
    K = np.random.default_rng(seed).uniform(-1.0, 1.0, 4)
    seen = ekf.innovation(prior, 5.0, a, 0.3)
    H = np.concatenate([seen.g, np.zeros(2)])
    root = np.linalg.cholesky(prior.P)
    left = root - np.outer(K, H @ root)  # the error's dependence on the prior's, and on the noise
    P = left @ left.T + 0.09 * np.outer(K, K)
    np.testing.assert_allclose(ekf.update(prior, seen, K).P, P, atol=1e-10)


def test_a_target_over_its_node_is_no_division_by_zero():
    prior = Gaussian(np.zeros(4), np.eye(4))
    got = ekf.update(prior, ekf.innovation(prior, 0.5, np.zeros(3), 0.1))
    assert np.all(np.isfinite(got.m))
    assert np.all(np.isfinite(got.P))


# --- manoeuvres


def seen_of(nu, S=1.0):
    nu = np.asarray(nu, dtype=float)
    return ekf.Innovation(nu, np.zeros((*nu.shape, 2)), np.full(nu.shape, S), np.full(nu.shape, S))


def test_a_manoeuvre_is_a_sum_of_innovations_and_not_one_wrong_range():
    watch = manoeuvre.calm((2,), 4)
    for nus in ([2.2, 0.0], [2.2, 0.0], [2.2, 0.0]):
        watch, beyond = manoeuvre.observe(watch, seen_of(nus), 18.5)
        assert not beyond.any()
    watch, beyond = manoeuvre.observe(watch, seen_of([2.2, 100.0]), 18.5)
    assert beyond.tolist() == [True, False]


def test_ranges_that_are_lost_do_not_calm_a_watch_and_after_an_answer_it_rests():
    watch = manoeuvre.calm((1,), 3)
    for nu, expected in ((2.6, False), (2.6, False), (np.nan, False), (2.6, True), (2.6, True)):
        watch, beyond = manoeuvre.observe(watch, seen_of([nu]), 18.5)
        assert beyond.tolist() == [expected]
    watch = manoeuvre.answered(watch, np.array([True]), 3)
    for expected in (False, False, True):  # the third range after it
        watch, beyond = manoeuvre.observe(watch, seen_of([2.9]), 18.5)
        assert beyond.tolist() == [expected]


@properties
@given(st.integers(0, 10**6))
def test_an_extra_gain_never_goes_beyond_what_the_range_says(seed):
    prior, a = belief(seed), place(seed)
    x_ls = prior.m + np.random.default_rng(seed).standard_normal(4)
    P_z = manoeuvre.error_covariance(prior.m, x_ls, 0.02, 0.2)
    np.testing.assert_allclose(P_z - np.outer(x_ls - prior.m, x_ls - prior.m), np.diag([4e-4, 4e-4, 0.04, 0.04]))
    seen = ekf.innovation(prior, 5.0, a, 0.02)
    K, K_z = ekf.gain(prior.P, seen.g, seen.R), manoeuvre.extra_gain(P_z, seen)
    together = manoeuvre.with_extra(K, K_z, seen.g)
    assert np.dot(together[:2], seen.g) <= 1.0 + 1e-12
    np.testing.assert_allclose(manoeuvre.with_extra(K, 0.0 * K_z, seen.g), K)


# --- two models


@properties
@given(st.floats(0.05, 0.99), st.floats(0.05, 0.99), st.integers(0, 12))
def test_steps_of_a_chain_are_powers_of_its_matrix(stay, other, steps):
    if stay + other >= 1.0:
        Pi = np.array([[stay, 1.0 - stay], [1.0 - other, other]])
        expected = np.linalg.matrix_power(Pi, steps)
        np.testing.assert_allclose(imm.transition((stay, other), steps), expected, atol=1e-12)
        half = imm.transition((stay, other), 0.5 * steps)
        np.testing.assert_allclose(half @ half, expected, atol=1e-12)


def test_a_chain_that_never_changes_stays():
    np.testing.assert_array_equal(imm.transition((1.0, 1.0), 5.0), np.eye(2))


@pytest.mark.parametrize('stay', [(1.0, 0.9), (1.0, 0.0), (0.0, 1.0)])
def test_a_model_that_nothing_leads_to_begins_where_the_others_are(stay):
    prior = Gaussian(np.array([5.0, 6.0, 1.0, 0.0]), np.eye(4))
    mixed = imm.mix(imm.of(prior, np.array([1.0 - 1e-12, 1e-12])), imm.transition(stay, 1.0))
    np.testing.assert_allclose(mixed.m, np.tile(prior.m, (2, 1)), rtol=1e-12)
    np.testing.assert_allclose(mixed.P, np.tile(prior.P, (2, 1, 1)), rtol=1e-12, atol=1e-12)


def test_equal_models_are_one_filter():
    prior, a = belief(5), place(5)
    models = imm.mix(imm.of(prior, np.array([0.3, 0.7])), imm.transition((0.95, 0.9), 1.0))
    seen = imm.innovation(models, np.asarray(6.0), a, np.asarray(0.1), np.asarray(0.0))
    merged = imm.merged(imm.update(models, seen))
    expected = ekf.update(prior, ekf.innovation(prior, 6.0, a, 0.1))
    np.testing.assert_allclose(merged.m, expected.m, atol=1e-12)
    np.testing.assert_allclose(merged.P, expected.P, atol=1e-12)


def test_the_model_that_foresaw_the_range_gains():
    """Against the two likelihoods, by hand."""
    prior = belief(6)
    models = imm.of(prior, np.array([0.5, 0.5]))
    models = models._replace(P=np.stack([prior.P, prior.P + 4.0 * np.eye(4)]))
    a = place(6)
    h = float(ekf.expected(prior.m, a)[0])
    for z in (h, h + 6.0):
        seen = imm.innovation(models, np.asarray(z), a, np.asarray(0.1), np.asarray(0.0))
        weight = 0.5 * np.exp(-0.5 * (z - h) ** 2 / seen.S) / np.sqrt(seen.S)
        np.testing.assert_allclose(imm.update(models, seen).mu, weight / weight.sum(), atol=1e-9)
    lost = imm.update(models, imm.innovation(models, np.asarray(np.nan), a, np.asarray(0.1), np.asarray(0.0)))
    np.testing.assert_array_equal(lost.m, models.m)
    np.testing.assert_allclose(lost.mu, models.mu)


# --- all ranges at once


def test_ranges_at_once_without_an_extra_gain_are_one_kalman_update():
    prior, rng = belief(7), np.random.default_rng(7)
    a = np.array([place(k) for k in range(5)])
    z = ekf.expected(prior.m, a)[0] + 0.1 * rng.standard_normal(5)
    z[3] = np.nan
    seen = frozen_gain.linearised(prior, z, a, np.full(5, 0.1), np.zeros(5))
    got = frozen_gain.update(prior, seen, np.zeros((4, 5)))
    H = np.array([[*ekf.expected(prior.m, a[j])[1], 0.0, 0.0] for j in (0, 1, 2, 4)])
    nu = np.delete(z - ekf.expected(prior.m, a)[0], 3)
    S = H @ prior.P @ H.T + 0.01 * np.eye(4)
    K = prior.P @ H.T @ np.linalg.inv(S)
    np.testing.assert_allclose(got.m, prior.m + K @ nu, atol=1e-10)
    np.testing.assert_allclose(got.P, (np.eye(4) - K @ H) @ prior.P, atol=1e-10)
    whole, each = frozen_gain.squared(prior, seen)
    assert whole == pytest.approx(nu @ np.linalg.inv(S) @ nu)
    np.testing.assert_allclose(np.delete(each, 3), nu**2 / np.diag(S))


def test_ranges_that_are_left_out_are_as_if_they_had_not_been_heard():
    prior = belief(8)
    a = np.array([place(k) for k in range(4)])
    z = ekf.expected(prior.m, a)[0] + 0.1
    some = np.array([False, True, False, False])
    seen = frozen_gain.linearised(prior, z, a, np.full(4, 0.1), np.zeros(4))
    never = frozen_gain.linearised(prior, np.where(some, np.nan, z), a, np.full(4, 0.1), np.zeros(4))
    K_z = np.random.default_rng(8).standard_normal((4, 4))
    one, two = frozen_gain.update(prior, frozen_gain.without(seen, some), K_z), frozen_gain.update(prior, never, K_z)
    np.testing.assert_array_equal(one.m, two.m)
    np.testing.assert_array_equal(one.P, two.P)
