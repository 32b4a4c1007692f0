"""The mean and local covariance intersection (seed 000, eq. 24 to 26), which tell no accuracy."""

import numpy as np
from fusion_cases import estimates
from hypothesis import given
from hypothesis import strategies as st
from oracles import ci, properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion


def test_the_mean_says_nothing_of_its_error():
    m, P = estimates(1, 5, 3)
    fused = fusion.mean(m, P)
    np.testing.assert_allclose(fused.m, m.sum(axis=-2) / 3.0)
    assert fused.P.shape == (5, 4, 4)
    assert np.isnan(fused.P).all()


def test_lci_recursion_by_hand():
    """Three states on a line, a = 0.5: the deviations from their mean 2 are -1, 0 and 1, then -2, 1, 1 from 3."""
    P = np.broadcast_to(4.0 * np.eye(1), (3, 1, 1))
    P = fusion.spread(P, np.array([[1.0], [2.0], [3.0]]), a=0.5, floor=1e-10)
    np.testing.assert_allclose(P[:, 0, 0], [2.5, 2.0, 2.5], rtol=1e-9)
    m = np.array([[1.0], [4.0], [4.0]])
    P = fusion.spread(P, m, a=0.25, floor=0.0)
    np.testing.assert_allclose(P[:, 0, 0], [0.25 * 4 + 0.75 * 2.5, 0.25 + 0.75 * 2, 0.25 + 0.75 * 2.5], rtol=1e-9)
    # weights 1/P, informations 1/P: x = sum(m / P^2) / sum(1 / P^2)
    p = P[:, 0, 0]
    np.testing.assert_allclose(fusion.lci(m, P).m, [(m[:, 0] / p**2).sum() / (1.0 / p**2).sum()], rtol=1e-12)


@properties
@given(seeds, st.integers(1, 5), st.floats(0.01, 0.99))
def test_lci_is_ci_over_its_own_spread_and_publishes_no_accuracy(seed, J, a):
    rng = np.random.default_rng(seed)
    P = np.broadcast_to(np.diag([0.01, 0.01, 0.0036, 0.0036]), (J, 4, 4))
    dense = P.copy()
    for _ in range(6):
        m = rng.standard_normal((J, 4)) * 0.1
        d = m - m.sum(axis=0) / J
        dense = np.array([a * np.outer(d[j], d[j]) + (1.0 - a) * dense[j] + 1e-10 * np.eye(4) for j in range(J)])
        P = fusion.spread(P, m, a)
        np.testing.assert_allclose(P, dense, rtol=1e-12, atol=1e-18)
    fused = fusion.lci(m, P)
    np.testing.assert_allclose(fused.m, ci(m, dense, fusion.trace_weights(dense))[0], atol=1e-6)
    assert np.isnan(fused.P).all()


def test_lci_survives_estimates_that_agree_for_ever():
    """Their deviations are zero: only the floor keeps the spread from vanishing."""
    m, P = np.ones((3, 4)), np.broadcast_to(np.eye(4), (3, 4, 4))
    for _ in range(2000):
        P = fusion.spread(P, m, a=0.9)
    np.testing.assert_allclose(fusion.lci(m, P).m, 1.0, rtol=1e-9)
