"""Offsets of links that drift, marginalised out of a particle filter.

Furniture, posture and reflections make a link read too much or too little for some seconds. Given the path of a
particle, the offset of each link is a Gauss-Markov process that is seen through noise: a Kalman filter of one state a
particle and node takes the place of another dimension to draw (Rao-Blackwellised particle filter: Schoen, Gustafsson,
Nordlund, IEEE Transactions on Signal Processing 53, 2005). Its mean belongs to the particle; its variance does not
depend on what was read, so that one a node serves all particles. With Student-t noise, whose Kalman gain does depend
on it, the particles' mean variance is kept.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats


class Drift(NamedTuple):
    """A stationary process: b <- a b + w, a = exp(-dt / time), w ~ N(0, std^2 (1 - a^2))."""

    std: float  # [dB]
    time: float  # [s]


class Offsets(NamedTuple):
    """What is believed of the links."""

    b: Floats  # (..., N, P) [dB] mean of each particle
    V: Floats  # (..., N) [dB^2] variance, of all particles


def unknown(drift: Drift, shape: tuple[int, ...], P: int) -> Offsets:
    """Of links (..., N) of which nothing is known."""
    return Offsets(np.zeros((*shape, P)), np.full(shape, drift.std**2))


def drifted(offsets: Offsets, drift: Drift, dt: float) -> Offsets:
    """dt [s] later."""
    a = math.exp(-max(dt, 0.0) / drift.time)
    return Offsets(a * offsets.b, a * a * offsets.V + drift.std**2 * (1.0 - a * a))


def learnt(offsets: Offsets, e: Floats, sigma: Floats, w: Floats, dof: float = 0.0) -> Offsets:
    """After an epoch: e (..., N, P) [dB] what each node read beyond what a particle with these offsets expects.

    NaN: not heard. sigma (..., N) [dB]: scale of the noise, Student-t of `dof` degrees of freedom or normal (0).
    w (..., P): weights of the particles after that epoch. Student-t: the noise that is most likely behind e, in
    variance sigma^2 / lambda, lambda = (dof + 1) / (dof + e^2 / (V + sigma^2)), as in expectation-maximisation.
    """
    b, V = offsets
    R = (sigma**2)[..., None]
    heard, e = ~np.isnan(e), np.nan_to_num(e)
    if dof:
        R = R * (dof + e * e / (V[..., None] + R)) / (dof + 1.0)
    K = np.where(heard, V[..., None] / (V[..., None] + R), 0.0)
    return Offsets(b + K * e, V * (1.0 - (K @ w[..., None])[..., 0]))
