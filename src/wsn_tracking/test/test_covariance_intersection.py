"""Fusion under unknown correlation: equations 20 to 26 of seed 000, their optimum, and ICI."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import at_least, ci, ci_trace, covariances, ici_pair, minimiser, optimality_gap, properties, seeds

from wsn_tracking.fusion import covariance_intersection as fusion
from wsn_tracking.fusion.simplex import minimise_trace, objective

counts = st.integers(1, 5)
sizes = st.integers(1, 5)


def estimates(seed, *shape, n=4, condition=1e3):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((*shape, n)), covariances(rng, *shape, n=n, condition=condition)


def best_weights(P):
    return minimise_trace(fusion.information(P), fusion.trace_weights(P))


# --- covariance intersection


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


# --- the optimal weights


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
    values = [objective(Y, minimise_trace(Y, w)) for w in (*corners, np.full((20, 4), 0.25))]
    np.testing.assert_allclose(values, np.broadcast_to(values[-1], (5, 20)), rtol=1e-9)


@properties
@given(seeds, st.integers(2, 5))
def test_optimum_is_no_worse_than_any_split(seed, J):
    _, P = estimates(seed, J)
    best = ci_trace(P, best_weights(P))
    for w in np.random.default_rng(seed).dirichlet(np.full(J, 0.7), 20):
        assert best <= ci_trace(P, w) * (1.0 + 1e-9)
    assert best <= np.trace(P, axis1=-2, axis2=-1).min() * (1.0 + 1e-9)


# --- mean and local covariance intersection


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


# --- inverse covariance intersection


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


# --- invariances of every rule

RULES = {'trace': fusion.trace, 'optimal': fusion.optimal, 'ici': fusion.ici, 'mean': fusion.mean, 'lci': fusion.lci}
rules = st.sampled_from(list(RULES.values()))


@properties
@given(seeds, st.integers(2, 5), st.permutations(range(5)))
def test_neighbours_may_come_in_any_order(seed, J, order):
    m, P = estimates(seed, J)
    order = [j for j in order if j < J]
    for rule in (fusion.trace, fusion.optimal, fusion.mean, fusion.lci):
        fused, shuffled = rule(m, P), rule(m[order], P[order])
        tolerance = 1e-7 if rule is fusion.optimal else 1e-12  # of the mean: where the optimum is flat
        np.testing.assert_allclose(shuffled.m, fused.m, atol=tolerance * max(1.0, np.abs(m).max()))
        np.testing.assert_allclose(np.trace(shuffled.P), np.trace(fused.P), rtol=1e-12)


@properties
@given(rules, seeds, st.integers(1, 4), st.floats(1e-3, 1e3))
def test_units_do_not_matter(rule, seed, J, unit):
    m, P = estimates(seed, J, condition=100.0)
    here, there = rule(m, P), rule(unit * m, unit**2 * P)
    np.testing.assert_allclose(there.m, unit * here.m, rtol=1e-6, atol=unit * 1e-6)
    np.testing.assert_allclose(there.P, unit**2 * here.P, rtol=1e-5, atol=unit**2 * 1e-6)


@properties
@given(rules, seeds, st.integers(1, 4))
def test_rotation_and_shift_of_the_frame_do_not_matter(rule, seed, J):
    m, P = estimates(seed, J, condition=100.0)
    rng = np.random.default_rng(seed)
    U, shift = np.linalg.qr(rng.standard_normal((4, 4)))[0], rng.standard_normal(4)
    here, there = rule(m, P), rule(m @ U.T + shift, U @ P @ U.T)
    np.testing.assert_allclose(there.m, here.m @ U.T + shift, atol=1e-6)
    np.testing.assert_allclose(there.P, U @ here.P @ U.T, atol=1e-6)


@pytest.mark.parametrize('name', RULES)
def test_a_batch_equals_its_sets_one_by_one(name):
    m, P = estimates(12, 4, 2, 3)
    batch = RULES[name](m, P)
    for i in np.ndindex(4, 2):
        one = RULES[name](m[i], P[i])
        np.testing.assert_allclose(batch.m[i], one.m, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(batch.P[i], one.P, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize('name', RULES)
def test_one_estimate_alone_stays_itself(name):
    m, P = estimates(13, 1)
    fused = RULES[name](m, P)
    np.testing.assert_allclose(fused.m, m[0], rtol=1e-9)
    assert np.isnan(fused.P).all() or np.allclose(fused.P, P[0], rtol=1e-9)
