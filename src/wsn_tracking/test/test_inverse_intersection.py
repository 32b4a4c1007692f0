"""Inverse covariance intersection: the published formula, consistent, between CI and independence."""

import numpy as np
import pytest
from fusion_cases import estimates, sizes
from hypothesis import given
from oracles import at_least, covariances, ici_pair, minimiser, properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion


@properties
@given(seeds, sizes)
def test_ici_pair_is_the_published_formula(seed, n):
    m, P = estimates(seed, 2, n=n, condition=100.0)
    w = minimiser(lambda v: np.trace(ici_pair(m[0], P[0], m[1], P[1], v)[1]))
    expected_m, expected_P, K, L = ici_pair(m[0], P[0], m[1], P[1], w)
    np.testing.assert_allclose(K + L, np.eye(n), atol=1e-9)
    fused = fusion.ici(m, P)
    # where the minimum is flat, w is known to the root of the precision
    np.testing.assert_allclose(fused.m, expected_m, atol=1e-5)
    np.testing.assert_allclose(fused.P, expected_P, atol=1e-5)
    assert np.trace(fused.P) == pytest.approx(np.trace(expected_P), rel=1e-9)


@properties
@given(seeds)
def test_ici_is_consistent_for_estimates_with_common_information(seed):
    """Both estimates hold the same part (Gamma) beside one of their own: P_AB = P_A Gamma^-1 P_B."""
    rng = np.random.default_rng(seed)
    own_A, own_B, Gamma = np.linalg.inv(covariances(rng, 3, n=3, condition=100.0) * rng.uniform(0.1, 10.0, (3, 1, 1)))
    P_A, P_B = np.linalg.inv(own_A + Gamma), np.linalg.inv(own_B + Gamma)
    P_AB = P_A @ Gamma @ P_B
    gains = fusion.ici(np.eye(6).reshape(6, 2, 3), np.broadcast_to(np.stack([P_A, P_B]), (6, 2, 3, 3))).m.T
    joint = np.block([[P_A, P_AB], [P_AB.T, P_B]])
    told = fusion.ici(np.zeros((2, 3)), np.stack([P_A, P_B])).P
    assert at_least(told, gains @ joint @ gains.T)


@properties
@given(seeds)
def test_ici_knows_more_than_ci_and_less_than_independence(seed):
    m, P = estimates(seed, 2, condition=100.0)
    ici = np.trace(fusion.ici(m, P).P)
    assert ici <= np.trace(fusion.optimal(m, P).P) * (1.0 + 1e-9)
    assert ici >= np.trace(np.linalg.inv(np.linalg.inv(P).sum(axis=0)))


def test_ici_of_three_is_pair_after_pair():
    m, P = estimates(9, 3)
    first = fusion.ici(m[:2], P[:2])
    expected = fusion.ici(np.stack([first.m, m[2]]), np.stack([first.P, P[2]]))
    fused = fusion.ici(m, P)
    np.testing.assert_array_equal(fused.m, expected.m)
    np.testing.assert_array_equal(fused.P, expected.P)
