"""Covariance intersection: equations 20 and 21 of seed 000, conservative whatever the correlation."""

import numpy as np
import pytest
from fusion_cases import best_weights, counts, estimates, sizes
from hypothesis import given
from hypothesis import strategies as st
from oracles import at_least, ci, properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion


@properties
@given(seeds, counts, sizes)
def test_trace_weights_are_a_split_in_proportion_to_one_over_the_trace(seed, J, n):
    _, P = estimates(seed, 3, J, n=n)
    w = fusion.trace_weights(P)
    np.testing.assert_allclose(w.sum(axis=-1), 1.0, rtol=1e-14)
    w_times_trace = w * np.trace(P, axis1=-2, axis2=-1)
    np.testing.assert_allclose(w_times_trace, np.broadcast_to(w_times_trace[:, :1], w.shape), rtol=1e-12)


def test_the_documents_weights_as_printed_would_not_sum_to_one():
    """Equation 23 has the sum of the traces below the line; with three equal traces of 2 its weights sum to 1/4."""
    P = np.broadcast_to(np.eye(2), (3, 2, 2))
    t = np.trace(P, axis1=-2, axis2=-1)
    assert (1.0 / t / t.sum()).sum() == pytest.approx(0.25)
    np.testing.assert_allclose(fusion.trace_weights(P), 1.0 / 3.0)


@properties
@given(seeds, counts, sizes)
def test_intersection_is_equations_20_and_21(seed, J, n):
    m, P = estimates(seed, J, n=n)
    for rule, w in ((fusion.trace, fusion.trace_weights(P)), (fusion.optimal, best_weights(P))):
        fused = rule(m, P)
        expected_m, expected_P = ci(m, P, w)
        np.testing.assert_allclose(fused.m, expected_m, rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(fused.P, expected_P, rtol=1e-8, atol=1e-10)
        np.testing.assert_array_equal(fused.P, np.swapaxes(fused.P, -1, -2))


@properties
@given(seeds, st.integers(1, 4), st.integers(1, 12))
def test_fused_covariance_is_conservative_whatever_the_correlation(seed, J, rank):
    """Any joint covariance whose blocks are the P_j: the true error of the fused mean is within what is told."""
    n, rng = 3, np.random.default_rng(seed)
    root = rng.standard_normal((J * n, rank)) * 10.0 ** rng.uniform(-1.0, 1.0, (J * n, 1))
    joint = root @ root.T + 1e-3 * np.eye(J * n)
    P = np.stack([joint[i * n : (i + 1) * n, i * n : (i + 1) * n] for i in range(J)])
    for rule in (fusion.trace, fusion.optimal):
        # the mean is linear in the estimates: its gains are what it makes of unit vectors
        inputs = np.eye(J * n).reshape(J * n, J, n)
        gains = rule(inputs, np.broadcast_to(P, (J * n, *P.shape))).m.T
        np.testing.assert_allclose(gains.reshape(n, J, n).sum(axis=1), np.eye(n), atol=1e-7)  # unbiased
        assert at_least(rule(np.zeros((J, n)), P).P, gains @ joint @ gains.T)


@properties
@given(seeds, counts)
def test_equal_estimates_gain_nothing(seed, J):
    m, P = estimates(seed)
    many_m, many_P = np.broadcast_to(m, (J, 4)), np.broadcast_to(P, (J, 4, 4))
    for rule in (fusion.trace, fusion.optimal, fusion.ici):
        fused = rule(many_m, many_P)
        np.testing.assert_allclose(fused.m, m, atol=1e-9)
        np.testing.assert_allclose(fused.P, P, rtol=1e-8, atol=1e-10)
