"""Many nodes of one make: what all have in common helps each of which little is known (empirical Bayes).

Node k's coefficients are drawn from the population, beta_k ~ N(mean, spread); its data tell it with information A_k.
Population and nodes are found together by expectation-maximisation (Dempster, Laird, Rubin 1977).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats

PASSES = 200
CLOSE = 1e-8


class PopulationPrior(NamedTuple):
    """What is known of the population before any data."""

    mean: Floats  # (p,)
    std: Floats  # (p,) of the mean
    spread: Floats  # (p,) standard deviation of the nodes about the mean
    scatter: float  # of readings about a node's trend
    strength: float = 2.0  # nodes that the assumed spread counts for


class Shrunk(NamedTuple):
    """Population and nodes."""

    mean: Floats  # (p,)
    mean_cov: Floats  # (p, p) how well the mean is known
    spread: Floats  # (p, p) covariance of the nodes about the mean
    beta: Floats  # (N, p)
    cov: Floats  # (N, p, p), what is not known of the mean included


def shrink(A: Floats, b: Floats, prior: PopulationPrior) -> Shrunk:
    """Estimates from information A (N, p, p) and A beta, b (N, p); zeros for a node without data.

    A node with much data keeps its own estimate; one without has the mean, and the spread as its uncertainty.
    """
    N = len(b)
    strength = prior.strength
    assumed = np.diag(np.square(prior.spread))
    prior_precision = np.diag(1.0 / np.square(prior.std))
    spread = assumed.copy()
    mean = prior.mean.copy()
    for _ in range(PASSES):
        T = precision_of(spread)
        V = precision_of(A + T)
        # d b / d mean: how much of the mean's information each node passes on
        gain = T - T @ V @ T
        mean_cov = precision_of(gain.sum(axis=0) + prior_precision)
        before = mean
        mean = mean_cov @ ((T @ (V @ b[..., None]))[..., 0].sum(axis=0) + prior_precision @ prior.mean)
        beta = (V @ (b + T @ mean)[..., None])[..., 0]
        away = beta - mean
        seen = (away[:, :, None] * away[:, None, :] + V).sum(axis=0)
        last, spread = spread, (strength * assumed + seen) / (strength + N)
        if np.allclose(spread, last, rtol=CLOSE, atol=0.0) and np.allclose(mean, before, rtol=CLOSE, atol=CLOSE):
            break
    through = V @ T
    return Shrunk(mean, mean_cov, spread, beta, V + through @ mean_cov @ np.swapaxes(through, -1, -2))


def precision_of(P: Floats) -> Floats:
    """Precision of covariances of two or three rows, (..., p, p), or the other way; they are scaled first."""
    d = 1.0 / np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    D = d[..., :, None] * d[..., None, :]
    return np.asarray(np.linalg.solve(P * D, np.broadcast_to(np.eye(P.shape[-1]), P.shape)) * D)
