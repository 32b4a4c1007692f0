"""Extended Kalman filter on one range at a time (seed 001, section 1.2), in covariance form, batched.

States are x, y, and whatever follows. The gain may be another than the filter's own: Joseph's form keeps P true to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.linalg import matvec, transpose
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.radio import MIN_RANGE


class Gaussian(NamedTuple):
    """N(m, P)."""

    m: Floats  # (..., n)
    P: Floats  # (..., n, n)


class Innovation(NamedTuple):
    """What a range tells that was not expected: nu, NaN where nothing was heard, and H = [g, 0, ...]."""

    nu: Floats  # (...) [m]
    g: Floats  # (..., 2)
    S: Floats  # (...) [m^2]
    R: Floats  # (...) [m^2]

    @property
    def squared(self) -> Floats:
        """nu^2 / S, one on the average."""
        return np.asarray(np.square(self.nu) / self.S)


def predict(belief: Gaussian, F: Floats, Q: Floats) -> Gaussian:
    """Time update; F and Q (..., n, n)."""
    return Gaussian(matvec(F, belief.m), F @ belief.P @ transpose(F) + Q)


def expected(m: Floats, place: Floats) -> tuple[Floats, Floats]:
    """Distance (...) of states m (..., n) from nodes at place (..., 3), z from the target up; gradient (..., 2)."""
    offset = m[..., :2] - place[..., :2]
    d = np.maximum(np.sqrt(np.sum(np.square(offset), axis=-1) + np.square(place[..., 2])), MIN_RANGE)
    return d, np.asarray(offset / d[..., None])


def innovation(
    belief: Gaussian, z: Floats | float, place: Floats, std: Floats | float, share: Floats | float = 0.0
) -> Innovation:
    """Of ranges z (...) [m], one an element of the batch; R = std^2 + (share times the expected range)^2."""
    h, g = expected(belief.m, place)
    R = np.square(std) + np.square(share * h)
    return Innovation(np.asarray(z - h), g, spread(belief.P, g) + R, R)


def spread(P: Floats, g: Floats) -> Floats:
    """H P H' (...) with H = [g, 0, ...]."""
    return np.asarray(np.einsum('...i,...ij,...j->...', g, P[..., :2, :2], g))


def gain(P: Floats, g: Floats, R: Floats) -> Floats:
    """K = P H' / (H P H' + R), (..., n)."""
    return np.asarray(matvec(P[..., :, :2], g) / (spread(P, g) + R)[..., None])


def update(belief: Gaussian, seen: Innovation, K: Floats | None = None) -> Gaussian:
    """x + K nu, (I - K H) P (I - K H)' + K R K' (Joseph); where nothing was heard the prediction stays as it is."""
    K = gain(belief.P, seen.g, seen.R) if K is None else K
    heard = ~np.isnan(seen.nu)
    K = np.where(heard[..., None], K, 0.0)
    rest = np.eye(K.shape[-1]) - _outer(K, _padded(seen.g, K.shape[-1]))
    P = rest @ belief.P @ transpose(rest) + np.where(heard, seen.R, 0.0)[..., None, None] * _outer(K, K)
    return Gaussian(belief.m + K * np.where(heard, seen.nu, 0.0)[..., None], P)


def _padded(g: Floats, n: int) -> Floats:
    H = np.zeros((*g.shape[:-1], n))
    H[..., :2] = g
    return H


def _outer(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., :, None] * b[..., None, :])
