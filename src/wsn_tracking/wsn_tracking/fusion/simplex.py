"""Minimise tr (sum_j w_j Y_j)^-1 over the simplex: a projected Newton method with an active set, batched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats

STEPS = 60
HALVINGS = 30
TOLERANCE = 1e-12  # of the gradient's spread, relative to the objective


def objective(Y: Floats, w: Floats) -> Floats:
    """tr (sum_j w_j Y_j)^-1, (...); Y (..., J, n, n), w (..., J)."""
    return np.asarray(np.trace(_inverse(Y, w), axis1=-2, axis2=-1))


def minimise_trace(Y: Floats, w: Floats) -> Floats:
    """The weights (..., J) >= 0, summing to one, that minimise the objective; w is where to start.

    The objective is convex. A weight at zero is held there while its multiplier is not negative; the rest
    take a Newton step in the plane of sum zero, shortened to stay in the simplex and to descend.
    """
    for _ in range(STEPS):
        P = _inverse(Y, w)
        YP = Y @ P[..., None, :, :]
        PYP = P[..., None, :, :] @ YP
        f = np.trace(P, axis1=-2, axis2=-1)[..., None]
        gradient = -np.trace(PYP, axis1=-2, axis2=-1)
        # d2 tr P / dw_j dw_k = 2 tr(P Y_j P Y_k P)
        hessian = 2.0 * np.einsum('...jab,...kba->...jk', PYP, YP)
        centred = gradient - (w * gradient).sum(axis=-1, keepdims=True)
        free = (w > 0.0) | (centred < 0.0)
        residual = np.where(free, np.abs(centred), 0.0).max(axis=-1, keepdims=True)
        done = residual <= TOLERANCE * f
        if np.all(done):
            break
        for _ in range(w.shape[-1]):
            step = np.where(done, 0.0, _newton(hessian, gradient, free))
            blocked = free & (w == 0.0) & (step < 0.0)
            if not np.any(blocked):
                break
            free &= ~blocked
        w = _descend(Y, w, np.where(free, step, 0.0), f)
    return w


def _newton(H: Floats, g: Floats, free: NDArray[np.bool_]) -> Floats:
    """Step of the free weights that keeps their sum: solve [[H, 1], [1', 0]] [s, l] = [-g, 0]."""
    J = g.shape[-1]
    scale = np.trace(H, axis1=-2, axis2=-1)[..., None, None] / J
    both = free[..., :, None] & free[..., None, :]
    A = np.zeros((*g.shape[:-1], J + 1, J + 1))
    # a whiff of the identity: estimates that are equal leave H singular, and any split of their weight is right
    A[..., :J, :J] = np.where(both, H / scale, 0.0) + np.where(free[..., None], 1e-12, 1.0) * np.eye(J)
    A[..., :J, J] = A[..., J, :J] = free
    b = np.concatenate([np.where(free, -g, 0.0) / scale[..., 0], np.zeros((*g.shape[:-1], 1))], axis=-1)
    return np.asarray(np.linalg.solve(A, b[..., None])[..., :J, 0])


def _descend(Y: Floats, w: Floats, step: Floats, f: Floats) -> Floats:
    """The longest of the halved steps, cut at the border of the simplex, that does not raise the objective."""
    with np.errstate(divide='ignore', invalid='ignore'):
        limit = np.where(step < 0.0, -w / step, np.inf).min(axis=-1, keepdims=True)
    length = np.minimum(1.0, limit)
    for _ in range(HALVINGS):
        moved = np.maximum(w + length * step, 0.0)
        moved = np.where(moved < 1e-15, 0.0, moved)
        moved /= moved.sum(axis=-1, keepdims=True)
        worse = objective(Y, moved)[..., None] > f * (1.0 + 1e-15)
        if not np.any(worse):
            return moved
        length = np.where(worse, length / 2.0, length)
    return np.where(worse, w, moved)


def _inverse(Y: Floats, w: Floats) -> Floats:
    total = (w[..., None, None] * Y).sum(axis=-3)
    return np.linalg.solve(total, np.broadcast_to(np.eye(Y.shape[-1]), total.shape))
