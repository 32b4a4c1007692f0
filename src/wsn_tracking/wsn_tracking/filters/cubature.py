"""The third-degree spherical-radial cubature rule and the linear regression that it gives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def points(belief: Belief) -> Floats:
    """The 2n points m +- sqrt(n) chol_P e_i, shape (..., 2n, n) (seed 000, eq. 6 and 10)."""
    m, S = belief
    spread = np.sqrt(m.shape[-1]) * transpose(S)
    return np.concatenate([m[..., None, :] + spread, m[..., None, :] - spread], axis=-2)


class Regression(NamedTuple):
    """h(x) ~ z_hat + O u + E w with u = chol_P^-1 (x - m) and w ~ N(0, I): statistical linear regression.

    The deviations of paired points split exactly: their odd part is what is linear in u, their even part
    the linearisation error, so that P_zz = O O' + E E' and P_xz = chol_P O'.
    """

    z_hat: Floats  # (..., N)
    O: Floats  # (..., N, n)
    E: Floats  # (..., N, n)


def regress(h: Function, belief: Belief) -> Regression:
    """Regress h about a belief over its cubature points (seed 000, eq. 12 to 16)."""
    n = belief.m.shape[-1]
    Z = h(points(belief))
    plus, minus = Z[..., :n, :], Z[..., n:, :]
    z_hat = Z.mean(axis=-2)
    scale = 0.5 / np.sqrt(n)
    return Regression(
        z_hat,
        transpose(plus - minus) * scale,
        transpose(plus + minus - 2.0 * z_hat[..., None, :]) * scale,
    )
