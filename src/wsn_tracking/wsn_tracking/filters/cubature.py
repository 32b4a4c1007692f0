"""The third-degree spherical-radial cubature rule and the linear regression that it gives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def points(belief: Belief, kappa: float = 0.0) -> Floats:
    """The 2n points m +- sqrt(n + kappa) chol_P e_i, shape (..., 2n, n) (seed 000, eq. 6 and 10).

    kappa > 0 is the unscented rule: points further out, and the mean as one more, with weight kappa / (n + kappa).
    """
    m, S = belief
    spread = np.sqrt(m.shape[-1] + kappa) * transpose(S)
    sides = [m[..., None, :] + spread, m[..., None, :] - spread]
    return np.concatenate([*sides, m[..., None, :]] if kappa > 0.0 else sides, axis=-2)


class Regression(NamedTuple):
    """h(x) ~ z_hat + O u + E w with u = chol_P^-1 (x - m) and w ~ N(0, I): statistical linear regression.

    The deviations of paired points split exactly: their odd part is what is linear in u, their even part
    the linearisation error, so that P_zz = O O' + E E' and P_xz = chol_P O'.
    """

    z_hat: Floats  # (..., N)
    O: Floats  # (..., N, n): the odd part
    E: Floats  # (..., N, n), with kappa (..., N, n + 1): the even part


def regress(h: Function, belief: Belief, kappa: float = 0.0) -> Regression:
    """Regress h about a belief over its cubature (or unscented) points (seed 000, eq. 12 to 16)."""
    n = belief.m.shape[-1]
    Z = h(points(belief, kappa))
    plus, minus = Z[..., :n, :], Z[..., n : 2 * n, :]
    scale = 0.5 / np.sqrt(n + kappa)
    if kappa > 0.0:
        centre = Z[..., 2 * n, :]
        z_hat = (Z[..., : 2 * n, :].sum(axis=-2) * 0.5 + kappa * centre) / (n + kappa)
        last = (centre - z_hat)[..., None] * np.sqrt(kappa / (n + kappa))
    else:
        z_hat = Z.mean(axis=-2)
    O = transpose(plus - minus) * scale
    E = transpose(plus + minus - 2.0 * z_hat[..., None, :]) * scale
    return Regression(z_hat, O, np.concatenate([E, last], axis=-1) if kappa > 0.0 else E)
