"""The hybrid estimator to the letter (seed 001, eq. 8 to 15): an extra gain, frozen when a manoeuvre is found.

It belongs to ranges of many nodes at one instant. On one range at a time it diverges: what was the right way to one
node is a wrong way to the next.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.ekf import Gaussian, expected
from wsn_tracking.filters.linalg import matvec, transpose
from wsn_tracking.models.anchors import Floats, Mask

UNHEARD = 1.0  # variance in the row of a node that was not heard: it leaves the others as they are


class Together(NamedTuple):
    """Ranges of all nodes at one instant, linearised."""

    nu: Floats  # (..., N) [m]; zero where nothing was heard
    H: Floats  # (..., N, n); rows likewise
    R: Floats  # (..., N) [m^2]
    heard: Mask  # (..., N)


def linearised(belief: Gaussian, z: Floats, place: Floats, std: Floats, share: Floats) -> Together:
    """Ranges z (..., N), NaN: not heard, of nodes at place (N, 3); std and share as for one range."""
    heard = ~np.isnan(z)
    h, g = expected(belief.m[..., None, :], place)
    H = np.zeros((*z.shape, belief.m.shape[-1]))
    H[..., :2] = np.where(heard[..., None], g, 0.0)
    R = np.where(heard, np.square(std) + np.square(share * h), UNHEARD)
    return Together(np.where(heard, z - h, 0.0), H, R, heard)


def gain(P: Floats, seen: Together) -> Floats:
    """K = P H' (H P H' + R)^-1, (..., n, N); zero columns for nodes that were not heard."""
    HP = seen.H @ P
    S = HP @ transpose(seen.H) + seen.R[..., None] * np.eye(seen.R.shape[-1])
    return np.asarray(transpose(np.linalg.solve(S, HP)))


def squared(belief: Gaussian, seen: Together) -> tuple[Floats, Floats]:
    """nu' S^-1 nu (...), chi-squared of as many degrees as nodes were heard; and nu^2 / S of each alone (..., N)."""
    S = seen.H @ belief.P @ transpose(seen.H) + seen.R[..., None] * np.eye(seen.R.shape[-1])
    whole = np.sum(seen.nu * np.linalg.solve(S, seen.nu[..., None])[..., 0], axis=-1)
    return np.asarray(whole), np.asarray(np.square(seen.nu) / np.diagonal(S, axis1=-2, axis2=-1))


def without(seen: Together, left_out: Mask) -> Together:
    """The same without some of the ranges (..., N)."""
    kept = seen.heard & ~left_out
    R = np.where(kept, seen.R, UNHEARD)
    return Together(np.where(kept, seen.nu, 0.0), np.where(kept[..., None], seen.H, 0.0), R, kept)


def update(belief: Gaussian, seen: Together, K_z: Floats) -> Gaussian:
    """x + (K + K_z) nu with K_z (..., n, N), already faded; P true to that gain (Joseph)."""
    K = gain(belief.P, seen) + np.where(seen.heard[..., None, :], K_z, 0.0)
    rest = np.eye(belief.m.shape[-1]) - K @ seen.H
    P = rest @ belief.P @ transpose(rest) + (K * seen.R[..., None, :]) @ transpose(K)
    return Gaussian(belief.m + matvec(K, seen.nu), P)
