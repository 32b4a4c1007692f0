"""Interacting multiple models (Blom, Bar-Shalom 1988) on one range at a time, batched.

The models differ in their process noise alone; their axis stands before that of the states.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters import ekf
from wsn_tracking.filters.ekf import Gaussian, Innovation
from wsn_tracking.models.anchors import Floats

LEAST = 1e-12  # no model is ruled out for good
TINY = 1e-300  # nor is a way from one to another, so that every model begins with a mixture that sums to one


class Models(NamedTuple):
    """A belief under each of J models, and how probable each is."""

    m: Floats  # (..., J, n)
    P: Floats  # (..., J, n, n)
    mu: Floats  # (..., J)


def of(belief: Gaussian, mu: Floats) -> Models:
    """The same belief under all models, with prior probabilities mu (J,)."""
    shape, n = belief.m.shape[:-1], belief.m.shape[-1]
    J = mu.size
    return Models(
        np.broadcast_to(belief.m[..., None, :], (*shape, J, n)),
        np.broadcast_to(belief.P[..., None, :, :], (*shape, J, n, n)),
        np.broadcast_to(mu, (*shape, J)),
    )


def merged(models: Models) -> Gaussian:
    """Mean and covariance of the mixture."""
    return _mixture(models.m, models.P, models.mu)


def _mixture(m: Floats, P: Floats, w: Floats) -> Gaussian:
    mean = np.sum(w[..., None] * m, axis=-2)
    e = m - mean[..., None, :]
    return Gaussian(mean, np.sum(w[..., None, None] * (P + e[..., :, None] * e[..., None, :]), axis=-3))


def transition(stay: tuple[float, float], steps: float) -> Floats:
    """Pi (2, 2), rows from, columns to, over any number of steps of a chain that stays with these probabilities.

    Its eigenvalues are 1 and stay_0 + stay_1 - 1, so that fractions of a step and long gaps are exact as well.
    """
    a, b = 1.0 - stay[0], 1.0 - stay[1]
    if a + b == 0.0:
        return np.eye(2)
    resting = np.array([b, a]) / (a + b)
    left = max(1.0 - a - b, 0.0) ** steps
    return np.asarray(resting + left * (np.eye(2) - resting))


def mix(models: Models, Pi: Floats) -> Models:
    """What each model begins the step with, Pi (J, J)."""
    joint = np.maximum(models.mu[..., :, None] * Pi, TINY)
    mu = joint.sum(axis=-2)
    w = np.swapaxes(joint / mu[..., None, :], -1, -2)  # (..., to, from)
    mixed = _mixture(models.m[..., None, :, :], models.P[..., None, :, :, :], w)
    return Models(mixed.m, mixed.P, np.maximum(mu, LEAST))


def innovation(models: Models, z: Floats, place: Floats, std: Floats, share: Floats) -> Innovation:
    """Of ranges z (...) of nodes at place (..., 3), under each model (..., J)."""
    each = z[..., None], place[..., None, :], std[..., None], share[..., None]
    return ekf.innovation(Gaussian(models.m, models.P), *each)


def update(models: Models, seen: Innovation) -> Models:
    """Every model with its own gain; mu by the likelihoods N(nu; 0, S)."""
    belief = ekf.update(Gaussian(models.m, models.P), seen)
    log_l = np.where(np.isnan(seen.nu), 0.0, -0.5 * (np.square(seen.nu) / seen.S + np.log(seen.S)))
    weight = models.mu * np.exp(log_l - log_l.max(axis=-1, keepdims=True))
    weight = np.maximum(weight / weight.sum(axis=-1, keepdims=True), LEAST)
    return Models(belief.m, belief.P, weight / weight.sum(axis=-1, keepdims=True))
