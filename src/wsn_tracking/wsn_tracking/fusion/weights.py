"""Weights of consensus, and how fast they agree."""

from __future__ import annotations

import math

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats, Mask

GAIN = 12.0  # what Chebyshev's rounds must gain before they are worth their risk
CONNECTED = 1.0 - 1e-9  # an eigenvalue beyond is that of a component


def metropolis(heard: Mask, degree: Floats) -> Floats:
    """Weights w_ij = 1 / (1 + max(d_i, d_j)) of what node i hears of node j, and w_ii = 1 - sum, (..., N, N).

    `heard` may lack neighbours that the degrees (..., N) count: their weight goes to the node itself.
    """
    W = np.where(heard, 1.0 / (1.0 + np.maximum(degree[..., :, None], degree[..., None, :])), 0.0)
    own = 1.0 - W.sum(axis=-1)
    return np.asarray(W + own[..., None] * np.eye(W.shape[-1]))


def contraction(W: Floats) -> Floats:
    """rho: the largest absolute eigenvalue of weights (..., N, N) but for the components' ones, (...)."""
    values = np.linalg.eigvalsh(W)
    return np.asarray(np.max(np.where(values < CONNECTED, np.abs(values), 0.0), axis=-1))


def chebyshev_guard(rho: float) -> int:
    """Rounds from which on Chebyshev's polynomial gains GAIN: ceil(acosh(12) / acosh(1 / rho))."""
    if not 0.0 <= rho < 1.0:
        raise TrackingError(f'the weights contract by {rho}: expected at least 0 and less than 1')
    return 1 if rho < 1e-9 else math.ceil(math.acosh(GAIN) / math.acosh(1.0 / rho))


def chebyshev_factors(rho: float, rounds: int) -> list[float]:
    """Factor omega of every round t: x(t+1) = omega (W x(t) - x(t-1)) + x(t-1), the first being 1 (plain).

    The two-step form of the Chebyshev iteration (Golub and Varga 1961): the least that the slowest mode can keep.
    """
    omegas = [1.0] * rounds
    for t in range(1, rounds):
        omegas[t] = 1.0 / (1.0 - rho * rho * omegas[t - 1] / (2.0 if t == 1 else 4.0))
    return omegas
