"""Extended Kalman filter in square-root form: the tangent in the place of a regression, whole vectors of readings."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters import srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function

STEP = 1e-4  # [m] half of it to each side: far below what bends a reading, far above rounding


def predict(belief: Belief, f: Function, jacobian: Function, chol_Q: Floats) -> Belief:
    """Time update: the mean by f (..., n), the covariance by its jacobian (..., n, n) there."""
    return srckf.predict(belief, jacobian(belief.m), chol_Q)._replace(m=f(belief.m))


def update(belief: Belief, z: Floats, h: Function, noise: Function, seen: int) -> Belief:
    """Measurement update; arguments as `srckf.update` has them, h looks at the first `seen` states alone."""
    at = belief.m[..., None, :]
    return srckf.condition(belief, z, tangent(h, belief, seen), noise(at)[..., 0, :])


def tangent(h: Function, belief: Belief, seen: int) -> Regression:
    """h(x) ~ h(m) + O u with u = chol_P^-1 (x - m): no linearisation error is known."""
    m, chol_P = belief
    H = slope(h, m, seen)
    return Regression.of(h(m[..., None, :seen])[..., 0, :], H @ chol_P[..., :seen, :seen], np.zeros((*H.shape[:-1], 0)))


def slope(h: Function, m: Floats, seen: int) -> Floats:
    """dh/dx over the first `seen` states at m (..., n), (..., N, seen), by central differences.

    So a radio map needs no derivative of its own. Off by STEP^2 / 24 times the third derivative: for a logarithm of the
    distance d, (STEP / d)^2 / 12 of the slope.
    """
    step = 0.5 * STEP * np.concatenate([np.eye(seen), -np.eye(seen)])
    y = h(m[..., None, :seen] + step)
    return transpose(y[..., :seen, :] - y[..., seen:, :]) / STEP
