"""Fusion of estimates whose correlation is unknown: covariance intersection and its kin.

All rules take means (..., J, n) and covariances (..., J, n, n) of J estimates.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.linalg import identity, matvec, transpose
from wsn_tracking.fusion.simplex import minimise_trace
from wsn_tracking.models.anchors import Floats


class Fused(NamedTuple):
    """Mean (..., n) and covariance (..., n, n); a covariance of NaN says that the rule knows none."""

    m: Floats
    P: Floats


def information(P: Floats) -> Floats:
    """P^-1 (..., n, n) through a Cholesky factor, exactly symmetric."""
    L = np.linalg.cholesky(P)
    L_inv = np.linalg.solve(L, identity(P.shape[-1]).reshape((1,) * (P.ndim - 2) + P.shape[-2:]))
    return transpose(L_inv) @ L_inv


def trace_weights(P: Floats) -> Floats:
    """omega_j = (1/tr P_j) / sum_h (1/tr P_h), (..., J).

    Seed 000, eq. 23, whose print does not sum to one.
    """
    w = 1.0 / P.trace(axis1=-2, axis2=-1)
    return np.asarray(w / w.sum(axis=-1, keepdims=True))


def intersect(m: Floats, Y: Floats, w: Floats) -> Fused:
    """Covariance intersection (seed 000, eq. 20 and 21) of informations Y_j = P_j^-1 with weights w (..., J)."""
    weighted = w[..., None, None] * Y
    P = information(weighted.sum(axis=-3))
    return Fused(matvec(P, matvec(weighted, m).sum(axis=-2)), P)


def trace(m: Floats, P: Floats) -> Fused:
    """CI with the approximate weights of eq. 23."""
    return intersect(m, information(P), trace_weights(P))


def optimal(m: Floats, P: Floats) -> Fused:
    """CI with the weights that minimise tr P (seed 000, eq. 22, omega >= 0)."""
    Y = information(P)
    return intersect(m, Y, minimise_trace(Y, trace_weights(P)))


def mean(m: Floats, P: Floats) -> Fused:
    """The plain mean (seed 000, eq. 26); it says nothing of its error."""
    centre = m.mean(axis=-2)
    return Fused(centre, np.full((*centre.shape, centre.shape[-1]), np.nan))


def spread(P: Floats, m: Floats, a: float = 0.5, floor: float = 1e-10) -> Floats:
    """LCI's own recursion P_j <- a d d' + (1 - a) P_j, d = x_j - mean x (seed 000, eq. 24), (..., J, n, n).

    floor [m^2] times I keeps it invertible. This measures how far the estimates lie apart, not how wrong
    they are: it weighs them, and is never told as accuracy.
    """
    d = m - m.sum(axis=-2, keepdims=True) / m.shape[-2]
    return np.asarray(a * d[..., :, None] * d[..., None, :] + (1.0 - a) * P + floor * identity(m.shape[-1]))


def lci(m: Floats, P_spread: Floats) -> Fused:
    """Local covariance intersection: CI over `spread`, of which only the mean is told (seed 000, eq. 24)."""
    fused = intersect(m, information(P_spread), trace_weights(P_spread))
    return Fused(fused.m, np.full(fused.P.shape, np.nan))


def ici(m: Floats, P: Floats) -> Fused:
    """Inverse covariance intersection (Noack et al., Automatica 79, 2017), pair after pair in the order of J.

    P^-1 = P_A^-1 + P_B^-1 - G^-1, G = w P_A + (1 - w) P_B: less cautious than CI, consistent where the
    common part of the estimates has a covariance of that form. w minimises tr P by golden section.
    """
    fused = Fused(m[..., 0, :], P[..., 0, :, :])
    for j in range(1, m.shape[-2]):
        fused = _ici_pair(fused, Fused(m[..., j, :], P[..., j, :, :]))
    return fused


def _ici_pair(A: Fused, B: Fused) -> Fused:
    Y_A, Y_B = information(A.P), information(B.P)

    def fuse(w: Floats) -> tuple[Floats, Floats]:
        v = w[..., None, None]
        Y_G = information(v * A.P + (1.0 - v) * B.P)
        return information(Y_A + Y_B - Y_G), Y_G

    w = _golden(lambda w: np.trace(fuse(w)[0], axis1=-2, axis2=-1), A.m.shape[:-1])
    P, Y_G = fuse(w)
    v = w[..., None, None]
    told = matvec(Y_A - v * Y_G, A.m) + matvec(Y_B - (1.0 - v) * Y_G, B.m)
    return Fused(matvec(P, told), P)


def _golden(f: Callable[[Floats], Floats], shape: tuple[int, ...], steps: int = 32) -> Floats:
    """Minimise a convex f over [0, 1] for every element at once, to 0.618^steps; a border that is no worse is taken."""
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    low, high = np.zeros(shape), np.ones(shape)
    for _ in range(steps):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        go_left = f(left) < f(right)
        low, high = np.where(go_left, low, left), np.where(go_left, right, high)
    best = (low + high) / 2.0
    for border in (np.zeros(shape), np.ones(shape)):
        best = np.where(f(border) <= f(best), border, best)
    return np.asarray(best)
