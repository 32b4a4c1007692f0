"""Minimise tr (sum_j w_j Y_j)^-1 over the simplex: a projected Newton method with an active set, batched."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.linalg import every, identity, some
from wsn_tracking.models.anchors import Floats, Mask

STEPS = 60
HALVINGS = 30
TOLERANCE = 1e-12  # share of the objective that a last step gains: what is left after it is the square of that
NOISE = 1e-15  # rounding of the objective, relative
TINY = 1e-300  # keeps a weight at zero that stays there from 0 / 0


class Expansion(NamedTuple):
    """The objective about a point, to second order."""

    f: Floats  # (..., 1) tr P with P = (sum_j w_j Y_j)^-1
    g: Floats  # (..., J) df / dw_j = -tr P Y_j P
    H: Floats  # (..., J, J) d2f / dw_j dw_k = 2 tr P Y_j P Y_k P


def minimise_trace(Y: Floats, w: Floats) -> Floats:
    """The weights (..., J) >= 0, summing to one, that minimise tr (sum_j w_j Y_j)^-1; w is where to start.

    Y (..., J, n, n) informations. The objective is convex. A weight at zero is held there while its multiplier is not
    negative; the rest take a Newton step in the plane of sum zero, shortened to stay in the simplex and to descend.
    """
    here = expand(Y, w)
    done = np.zeros(here.f.shape, dtype=np.bool_)
    for _ in range(STEPS):
        step = np.where(done, 0.0, _direction(here, w))
        gain = -(step * here.g).sum(axis=-1, keepdims=True)
        last = gain <= TOLERANCE * here.f
        if every(last):
            return _moved(w, step, _limit(w, step))
        w, here, stuck = _descend(Y, w, here, step, last)
        done |= last | stuck
    return w


def expand(Y: Floats, w: Floats) -> Expansion:
    """The objective, its gradient and its Hessian at w."""
    P = _inverse(Y, w)
    PY = P[..., None, :, :] @ Y
    PYP = PY @ P[..., None, :, :]
    flat = (*PY.shape[:-2], PY.shape[-1] ** 2)
    rows = PY.reshape(flat)
    g = -(rows @ P.reshape(*P.shape[:-2], flat[-1], 1))[..., 0]
    return Expansion(P.trace(axis1=-2, axis2=-1)[..., None], g, 2.0 * PYP.reshape(flat) @ rows.swapaxes(-1, -2))


def _direction(here: Expansion, w: Floats) -> Floats:
    """The Newton step of the weights that are free to move, zero for the others."""
    above = here.g - (w * here.g).sum(axis=-1, keepdims=True)
    free = (w > 0.0) | (above < 0.0)
    step = _newton(here, free)
    for _ in range(w.shape[-1]):
        blocked = (w == 0.0) & (step < 0.0)
        if not some(blocked):
            break
        free &= ~blocked
        step = _newton(here, free)
    return step


def _newton(here: Expansion, free: Mask) -> Floats:
    """Step of the free weights that keeps their sum: solve [[H, 1], [1', 0]] [s, l] = [-g, 0]."""
    J = free.shape[-1]
    # a whiff of the identity: estimates that are equal leave H singular, and any split of their weight is right
    H = here.H / here.f[..., None] + 1e-12 * identity(J)
    if not every(free):
        H = np.where(free[..., :, None] & free[..., None, :], H, identity(J))
    A = np.zeros((*free.shape[:-1], J + 1, J + 2))  # the last column is the right hand side
    A[..., :J, :J] = H
    A[..., :J, J] = A[..., J, :J] = free
    A[..., :J, J + 1] = here.g * free / -here.f
    return np.asarray(np.linalg.solve(A[..., :-1], A[..., -1:])[..., :J, 0] * free)


def _descend(Y: Floats, w: Floats, here: Expansion, step: Floats, last: Mask) -> tuple[Floats, Expansion, Mask]:
    """The longest of the halved steps, cut at the border of the simplex, that does not raise the objective."""
    length = _limit(w, step)
    for _ in range(HALVINGS):
        moved = _moved(w, step, length)
        there = expand(Y, moved)
        worse = (there.f > here.f * (1.0 + NOISE)) & ~last
        if not some(worse):
            return moved, there, worse
        length = np.where(worse, length / 2.0, length)
    moved = np.where(worse, w, moved)
    return moved, expand(Y, moved), worse


def _limit(w: Floats, step: Floats) -> Floats:
    """How far, at most one step, the simplex reaches, (..., 1)."""
    return np.asarray(((w + TINY) / (np.maximum(-step, w) + TINY)).min(axis=-1, keepdims=True))


def _moved(w: Floats, step: Floats, length: Floats) -> Floats:
    moved = w + length * step
    moved = np.where(moved < NOISE, 0.0, moved)
    return np.asarray(moved / moved.sum(axis=-1, keepdims=True))


def _inverse(Y: Floats, w: Floats) -> Floats:
    flat = Y.reshape(*Y.shape[:-2], Y.shape[-1] ** 2)
    total = (w[..., None, :] @ flat)[..., 0, :].reshape(*w.shape[:-1], *Y.shape[-2:])
    return np.linalg.solve(total, identity(Y.shape[-1]).reshape((1,) * (total.ndim - 2) + Y.shape[-2:]))
