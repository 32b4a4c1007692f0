"""The likelihood of a field and what leaving out gives, against dense matrices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from wsn_tracking.sensing.field import Data, Hyper, cost, covariance, left_out


def example(seed=0, count=12):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 5.0, (count, 2))
    H = np.stack([np.ones((count, 2)), rng.normal(0.0, 2.0, (count, 2))], axis=-1)
    known = rng.random((count, 2)) > 0.2
    y = np.where(known, rng.normal(-60.0, 5.0, (count, 2)), 0.0)
    H = np.where(known[..., None], H, 0.0)
    trust = rng.uniform(0.3, 1.0, y.shape)
    data = Data(points, H, y, known, rng.integers(1, 9, y.shape) * 1.0, np.array([1.0, 2.0]), trust)
    return Hyper(3.0, 1.5, 0.7), data, np.array([-58.0, 1.0]), np.array([[4.0, 0.3], [0.3, 0.5]])


def dense(hyper, data, mean, spread, k):
    """Mean and covariance of node k's readings, written out."""
    there = np.flatnonzero(data.known[:, k])
    H = data.H[there, k]
    C = np.empty((there.size, there.size))
    for i, a in enumerate(there):
        for j, b in enumerate(there):
            r = np.sqrt(3.0) * np.linalg.norm(data.points[a] - data.points[b]) / hyper.length
            C[i, j] = hyper.amplitude**2 * (1.0 + r) * np.exp(-r) + H[i] @ spread @ H[j]
        C[i, i] += (hyper.place**2 + data.packet[k] ** 2 / data.counts[a, k]) / data.trust[a, k]
    return data.y[there, k], H @ mean, C


def test_the_marginal_likelihood_is_that_of_a_dense_normal():
    hyper, data, mean, spread = example()
    other = hyper._replace(length=3.0, place=1.4)

    def oracle(h):
        parts = [dense(h, data, mean, spread, k) for k in range(2)]
        return -sum(multivariate_normal(m, C).logpdf(y) for y, m, C in parts)

    ours = cost(other, data, mean, spread) - cost(hyper, data, mean, spread)
    assert ours == pytest.approx(oracle(other) - oracle(hyper), rel=1e-9)


def test_left_out_is_what_leaving_out_gives():
    hyper, data, mean, spread = example(1)
    error, std = left_out(hyper, data, mean, spread)
    for k in range(2):
        y, m, C = dense(hyper, data, mean, spread, k)
        for i, place in enumerate(np.flatnonzero(data.known[:, k])):
            rest = np.delete(np.arange(y.size), i)
            gain = C[i, rest] @ np.linalg.inv(C[np.ix_(rest, rest)])
            assert error[place, k] == pytest.approx(y[i] - m[i] - gain @ (y - m)[rest])
            assert std[place, k] == pytest.approx(np.sqrt(C[i, i] - gain @ C[rest, i]))
    assert np.array_equal(np.isnan(error), ~data.known)


def test_an_unknown_reading_stands_alone():
    hyper, data, _, _ = example(2)
    C = covariance(hyper, data)
    place, node = np.argwhere(~data.known)[0]
    row = np.delete(C[node, place], place)
    assert np.all(row == 0.0)
    assert C[node, place, place] == 1.0
