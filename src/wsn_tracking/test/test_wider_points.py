"""Unscented points: wider than those of the cubature rule, with the same moments."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oracles import H, beliefs, covariances, kalman, properties, seeds

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import points, regress
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.filters.srckf import update
from wsn_tracking.models.measurement import constant_noise


@properties
@given(seeds, st.floats(0.1, 10.0))
def test_unscented_points_have_the_beliefs_mean_and_covariance(seed, kappa):
    m, P = beliefs(np.random.default_rng(seed), 3)
    X = points(Belief(m, np.linalg.cholesky(P)), kappa)
    w = np.array([*[0.5] * 8, kappa]) / (4.0 + kappa)
    np.testing.assert_allclose(w @ X, m, atol=1e-12)
    d = X - m[:, None]
    np.testing.assert_allclose(transpose(d) @ (w[:, None] * d), P, atol=1e-12)


@properties
@given(seeds, st.floats(0.1, 10.0))
def test_regression_keeps_every_moment_of_the_unscented_rule(seed, kappa):
    m, P = beliefs(np.random.default_rng(seed), position_std=0.4)
    belief = Belief(m, np.linalg.cholesky(P))
    X = points(belief, kappa)
    w = np.array([*[0.5] * 8, kappa]) / (4.0 + kappa)
    d = H(X) - w @ H(X)
    r = regress(H, belief, kappa)
    np.testing.assert_allclose(r.z_hat, w @ H(X), rtol=1e-12)
    np.testing.assert_allclose(r.O @ r.O.T + r.E @ r.E.T, d.T @ (w[:, None] * d), atol=1e-12)
    np.testing.assert_allclose(belief.chol_P @ r.O.T, (X - m).T @ (w[:, None] * d), atol=1e-12)


def test_wider_points_are_the_same_filter_on_a_linear_measurement():
    rng = np.random.default_rng(1)
    A, P, m, z = rng.standard_normal((6, 4)), covariances(rng), rng.standard_normal(4), rng.standard_normal(6)
    after = update(Belief(m, np.linalg.cholesky(P)), z, lambda x: x @ A.T, constant_noise(np.ones(6)), 2, kappa=3.0)
    expected = kalman(m, P, z, A, np.eye(6))
    np.testing.assert_allclose(after.m, expected[0], atol=1e-9)
    np.testing.assert_allclose(after.P, expected[1], atol=1e-9)
