"""The third-degree spherical-radial cubature rule and the linear regression that it gives."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import product, transpose
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def points(belief: Belief, kappa: float = 0.0) -> Floats:
    """The 2n points m +- sqrt(n + kappa) chol_P e_i, shape (..., 2n, n) (seed 000, eq. 6 and 10).

    kappa > 0 is the unscented rule: points further out, and the mean as one more, with weight kappa / (n + kappa).
    """
    m, S = belief
    n = m.shape[-1]
    root_and_mean = np.empty((*m.shape[:-1], n + 1, n))
    root_and_mean[..., :n, :] = transpose(S)
    root_and_mean[..., n, :] = m
    return product(_rule(n, kappa).directions, root_and_mean)


class Regression(NamedTuple):
    """h(x) ~ z_hat + O u + E w with u = chol_P^-1 (x - m) and w ~ N(0, I): statistical linear regression.

    The deviations of paired points split exactly: their odd part is what is linear in u, their even part
    the linearisation error, so that P_zz = O O' + E E' and P_xz = chol_P O'. Columns of O that are left out at the end
    are zero.
    """

    rows: Floats  # (..., e + d + 1, N): the columns of E, those of O from the last to the first, z_hat
    d: int  # columns of O

    @classmethod
    def of(cls, z_hat: Floats, O: Floats, E: Floats) -> Regression:
        """From z_hat (..., N), O (..., N, d) and E (..., N, e)."""
        columns = np.concatenate([E, O[..., ::-1], z_hat[..., None]], axis=-1)
        return cls(transpose(columns), O.shape[-1])

    @property
    def z_hat(self) -> Floats:
        """(..., N)."""
        return self.rows[..., -1, :]

    @property
    def O(self) -> Floats:  # noqa: E743
        """The odd part (..., N, d)."""
        return transpose(self.rows[..., -2 : -2 - self.d : -1, :])

    @property
    def E(self) -> Floats:
        """The even part (..., N, e)."""
        return transpose(self.rows[..., : -1 - self.d, :])


def regress(h: Function, belief: Belief, kappa: float = 0.0) -> Regression:
    """Regress h about a belief over its cubature (or unscented) points (seed 000, eq. 12 to 16).

    Where h looks only at the first d of n states, regress over these with kappa + n - d: the points that differ
    elsewhere all read the same, which is the centre of the smaller rule, and every moment stays as it was.
    """
    n = belief.m.shape[-1]
    return Regression(product(_rule(n, kappa).combinations, h(points(belief, kappa))), n)


class _Rule(NamedTuple):
    """The rule as two matrices."""

    directions: Floats  # (K, n + 1): the points, against the columns of the root and the mean
    combinations: Floats  # (2n + 1, K): the rows of a Regression, of the readings at the points


@lru_cache
def _rule(n: int, kappa: float) -> _Rule:
    """The centre's even part is spread over those of the pairs, so that E has n columns with any kappa.

    With t_k = y+_k + y-_k - 2 y_0 and s their sum, the even part of P_zz is 1 / (4 (n + kappa)) times
    T T' - s s' / (n + kappa), of which T (I - g 1 1') with (1 - n g)^2 = kappa / (n + kappa) is a root.
    """
    eye, one, scale = np.eye(n), np.ones((1, n)), 0.5 / np.sqrt(n + kappa)
    centre = np.sqrt(kappa / (n + kappa))  # 1 - n g
    even = eye - (1.0 - centre) / n
    odd = scale * eye[::-1]
    pairs = np.block([[scale * even, scale * even], [odd, -odd], [0.5 / (n + kappa) * one] * 2])
    middle = np.concatenate([np.full(n, -2.0 * scale * centre), np.zeros(n), [kappa / (n + kappa)]])
    away = np.sqrt(n + kappa) * eye
    directions = np.block([[away, one.T], [-away, one.T], [0.0 * one, 1.0]])
    if kappa == 0.0:
        return _Rule(directions[:-1], pairs)
    return _Rule(directions, np.column_stack([pairs, middle]))
