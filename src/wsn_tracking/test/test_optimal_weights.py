"""The weights of least trace leave nothing to gain, against peers, grids and bounds."""

import numpy as np
import pytest
from fusion_cases import best_weights, estimates
from hypothesis import given
from hypothesis import strategies as st
from oracles import ci_trace, minimiser, optimality_gap, properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion
from wsn_tracking.fusion.simplex import minimise_trace


@pytest.mark.parametrize('condition', [10.0, 1e4])
@pytest.mark.parametrize('J', [1, 2, 3, 5])
def test_optimal_weights_leave_nothing_to_gain(J, condition):
    _, P = estimates(J, 60, J, condition=condition)
    w = best_weights(P)
    assert np.all(w >= 0.0)
    np.testing.assert_allclose(w.sum(axis=-1), 1.0, rtol=1e-12)
    assert max(optimality_gap(p, v) for p, v in zip(P, w, strict=True)) < 1e-9


@pytest.mark.parametrize('J', [2, 3, 5])
def test_optimal_trace_is_that_of_slsqp(J):
    minimize = pytest.importorskip('scipy.optimize').minimize
    for seed in range(10):
        m, P = estimates(100 + seed, J, condition=300.0)
        ours = float(np.trace(fusion.optimal(m, P).P))
        peer = minimize(
            lambda w, P=P: ci_trace(P, w),
            np.full(J, 1.0 / J),
            method='SLSQP',
            bounds=[(0.0, 1.0)] * J,
            constraints={'type': 'eq', 'fun': lambda w: w.sum() - 1.0},
            options={'ftol': 1e-15, 'maxiter': 500},
        )
        theirs = ci_trace(P, np.maximum(peer.x, 0.0) / np.maximum(peer.x, 0.0).sum())
        assert ours <= theirs * (1.0 + 1e-9)
        assert ours == pytest.approx(theirs, rel=1e-6)  # the peer's own precision


@pytest.mark.parametrize('condition', [10.0, 1e4, 1e8])
def test_optimal_trace_is_that_of_a_grid_that_closes_in(condition):
    for seed in range(8):
        m, P = estimates(200 + seed, 2, condition=condition)
        v = minimiser(lambda v, P=P: ci_trace(P, np.array([v, 1.0 - v])))
        expected = ci_trace(P, np.array([v, 1.0 - v]))
        assert float(np.trace(fusion.optimal(m, P).P)) == pytest.approx(expected, rel=1e-9)


@properties
@given(seeds, st.integers(2, 5))
def test_optimum_with_equal_estimates_among_the_others(seed, J):
    _, P = estimates(seed, J)
    doubled = np.concatenate([P, P[:1], P[:1]])
    w = best_weights(doubled)
    assert optimality_gap(doubled, w) < 1e-6  # a loose bound; the trace itself is exact
    assert ci_trace(doubled, w) == pytest.approx(ci_trace(P, best_weights(P)), rel=1e-9)


@properties
@given(seeds, st.floats(1e-12, 1e-6))
def test_optimum_with_nearly_singular_estimates(seed, thin):
    """Each estimate knows one direction almost exactly and the others hardly.

    With 1e-12, exact rational arithmetic finds the trace 1e-9 above its minimum: the bound is a loose one.
    """
    rng = np.random.default_rng(seed)
    U = np.linalg.qr(rng.standard_normal((3, 3, 3)))[0]
    P = (U * np.array([thin, 1.0, 2.0])) @ np.swapaxes(U, -1, -2)
    P = (P + np.swapaxes(P, -1, -2)) / 2.0
    w = best_weights(P)
    assert np.all(np.isfinite(w))
    assert optimality_gap(P, w) < 1e-3
    assert optimality_gap(P, w) < 1e-5 or thin < 1e-9


def test_an_estimate_that_knows_everything_better_takes_all_weight():
    P = np.stack([4.0 * np.eye(4), np.eye(4), 1.1 * np.eye(4) + 3.0])
    np.testing.assert_array_equal(best_weights(P), [0.0, 1.0, 0.0])
    np.testing.assert_allclose(fusion.optimal(np.eye(3, 4), P).P, np.eye(4), atol=1e-14)


def test_the_start_does_not_matter_to_the_optimum():
    _, P = estimates(7, 20, 4)
    Y = fusion.information(P)
    corners = [np.broadcast_to(np.eye(4)[i], (20, 4)) for i in range(4)]
    found = [minimise_trace(Y, w) for w in (*corners, np.full((20, 4), 0.25))]
    values = [np.trace(np.linalg.inv(np.einsum('rj,rjab->rab', w, Y)), axis1=-2, axis2=-1) for w in found]
    np.testing.assert_allclose(values, np.broadcast_to(values[-1], (5, 20)), rtol=1e-9)


@properties
@given(seeds, st.integers(2, 5))
def test_optimum_is_no_worse_than_any_split(seed, J):
    _, P = estimates(seed, J)
    best = ci_trace(P, best_weights(P))
    for w in np.random.default_rng(seed).dirichlet(np.full(J, 0.7), 20):
        assert best <= ci_trace(P, w) * (1.0 + 1e-9)
    assert best <= np.trace(P, axis1=-2, axis2=-1).min() * (1.0 + 1e-9)
