"""Nodes of which little is known are drawn towards their population, no more than they should."""

from __future__ import annotations

import numpy as np

from wsn_tracking.sensing.shrinkage import PopulationPrior, shrink

PRIOR = PopulationPrior(np.array([0.0, 0.0]), np.array([100.0, 100.0]), np.array([1.0, 1.0]), 1.0)


def drawn(rng, nodes, mean, spread, counts):
    """Coefficients of a population, and what readings with unit noise tell of them."""
    beta = rng.multivariate_normal(mean, np.diag(np.square(spread)), nodes)
    A, b = np.zeros((nodes, 2, 2)), np.zeros((nodes, 2))
    for k, count in enumerate(counts):
        X = np.column_stack([np.ones(count), rng.uniform(-3.0, 3.0, count)])
        y = X @ beta[k] + rng.standard_normal(count)
        A[k], b[k] = X.T @ X, X.T @ y
    return beta, A, b


def test_much_data_speaks_for_itself_and_none_for_the_population():
    rng = np.random.default_rng(0)
    counts = [3000] * 9 + [0]
    _, A, b = drawn(rng, 10, [5.0, -2.0], [2.0, 0.5], counts)
    found = shrink(A, b, PRIOR)
    own = np.linalg.solve(A[:9], b[:9, :, None])[..., 0]
    np.testing.assert_allclose(found.beta[:9], own, atol=0.01)
    np.testing.assert_allclose(found.beta[9], found.mean, atol=1e-9)
    np.testing.assert_allclose(found.cov[9], found.spread + found.mean_cov, rtol=1e-6)


def test_little_data_lies_between_itself_and_the_population():
    rng = np.random.default_rng(1)
    _, A, b = drawn(rng, 12, [5.0, -2.0], [1.0, 0.3], [200] * 11 + [3])
    found = shrink(A, b, PRIOR)
    own = np.linalg.solve(A[11], b[11])
    T, V = np.linalg.inv(found.spread), np.linalg.inv(A[11] + np.linalg.inv(found.spread))
    np.testing.assert_allclose(found.beta[11], V @ (A[11] @ own + T @ found.mean), rtol=1e-6)
    assert np.all(np.linalg.eigvalsh(np.linalg.inv(A[11]) - V) > 0.0)


def test_shrinking_helps_those_of_whom_little_is_known():
    gains = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        beta, A, b = drawn(rng, 12, [5.0, -2.0], [0.7, 0.2], [4] * 12)
        found = shrink(A, b, PRIOR)
        own = np.linalg.solve(A, b[..., None])[..., 0]
        gains.append([np.sum((found.beta - beta) ** 2), np.sum((own - beta) ** 2)])
    ours, theirs = np.sum(gains, axis=0)
    assert ours < 0.75 * theirs


def test_intervals_of_shrunk_nodes_hold_the_truth():
    hits = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        beta, A, b = drawn(rng, 12, [5.0, -2.0], [1.0, 0.3], [3, 4, 5, 6, 8, 10, 12, 15, 20, 30, 50, 0])
        found = shrink(A, b, PRIOR)
        half = 1.96 * np.sqrt(np.diagonal(found.cov, axis1=1, axis2=2))
        hits.append(np.abs(found.beta - beta) < half)
    assert 0.92 < np.mean(hits) < 0.985


def test_the_order_of_nodes_is_indifferent():
    rng = np.random.default_rng(2)
    _, A, b = drawn(rng, 8, [1.0, 1.0], [1.0, 1.0], [5] * 8)
    order = rng.permutation(8)
    there, back = shrink(A, b, PRIOR), shrink(A[order], b[order], PRIOR)
    np.testing.assert_allclose(there.beta[order], back.beta, rtol=1e-9)
