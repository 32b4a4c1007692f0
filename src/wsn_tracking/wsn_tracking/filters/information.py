"""Information form of a belief, and what one node's range and bearing contribute to it (seed 002, section 2)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import regress
from wsn_tracking.filters.linalg import matvec, transpose
from wsn_tracking.filters.triangular import forward, inverse
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.arrival import NEGLIGIBLE, posterior
from wsn_tracking.models.measurement import POSITION, Function
from wsn_tracking.models.range_bearing import innovation

LOG_2PI = float(np.log(2.0 * np.pi))
ROUNDING = 1e-12  # of an eigenvalue, in units of the largest


class Information(NamedTuple):
    """y = P^-1 x and Y = P^-1 (seed 002, eq. 6), or a share of them."""

    vector: Floats  # (..., n)
    matrix: Floats  # (..., n, n)


class Contribution(NamedTuple):
    """What one observation adds, weighed with the probability that it is one."""

    information: Information  # i and I, eq. 21
    mu: Floats  # (...) probability of arrival, exactly 0 where nothing arrived


# Log density of what a node reads in the loss state: (z (..., 2), R (..., 2, 2), which rows were read) -> (...)
LossModel = Callable[[Floats, Floats, Mask], Floats]


def zero(z: Floats, R: Floats, read: Mask) -> Floats:
    """h = 0 in the loss state: the observation is its noise, l0 = log N(z; 0, R) (the document)."""
    return log_normal(np.where(read, z, 0.0), R, read)


def uniform(r_max: float) -> LossModel:
    """Anything may be read: a range of up to r_max [m] and any bearing."""
    cost = np.array([np.log(r_max), LOG_2PI])
    return lambda z, R, read: -np.asarray(np.sum(np.where(read, cost, 0.0), axis=-1))


def absent(z: Floats, R: Floats, read: Mask) -> Floats:
    """In the loss state nothing is read: whatever is read has arrived (the document's single model)."""
    return np.full(z.shape[:-1], -np.inf)


def log_normal(v: Floats, S: Floats, read: Mask) -> Floats:
    """log N(v; 0, S) over the rows that were read; the others are 0 in v and those of the unit matrix in S."""
    L = np.linalg.cholesky(S)
    w = forward(L, v[..., None])[..., 0]
    log_root = np.sum(np.log(np.diagonal(L, axis1=-2, axis2=-1)), axis=-1)
    return np.asarray(-0.5 * np.sum(w * w, axis=-1) - log_root - 0.5 * LOG_2PI * np.sum(read, axis=-1))


def contribute(
    prior: Belief,
    h: Function,
    z: Floats,
    R: Floats,
    pi_1: Floats,
    loss: LossModel,
    omega_weight: Floats | float = 1.0,
) -> Contribution:
    """Information of one observation of each node (seed 002, eq. 10 to 12 and 16 to 21).

    prior (..., n); h maps (..., K, n) to (..., K, 2) and looks at the position alone; z (..., 2) range [m] and
    bearing [rad], NaN where not read (a row that drops out); R (..., 2, 2); pi_1 and omega_weight (...). With the
    deviations O and E of the regression: P_zz = O O' + E E', H = (P^-1 P_xz)' = O chol_P^-1, and the linearisation
    error Omega = P_zz - H P H' = E E' adds to R, which makes the posterior that of the cubature Kalman filter.
    `omega_weight` times as much of it adds to what the observation is worth, though not to how likely it is: 0 is the
    form that the document prints; w counts an error that stays the same for w epochs as one, where 1 takes each as new.

    h regressed over the position alone with kappa = n - 2 has the moments of the cubature rule over all n states, since
    the points along the other axes of the (lower triangular) root share the mean's position.
    """
    m, root = prior.m[..., :POSITION], prior.chol_P[..., :POSITION, :POSITION]
    r = regress(h, Belief(m, root), kappa=float(prior.m.shape[-1] - POSITION))
    read = ~np.isnan(z)
    v = np.where(read, innovation(z, r.z_hat), 0.0)
    O, E = r.O * read[..., None], r.E * read[..., None]
    R = np.where(read[..., None] & read[..., None, :], R, np.eye(z.shape[-1]))
    Omega = E @ transpose(E)
    l1 = log_normal(v, R + Omega + O @ transpose(O), read)
    mu = np.where(np.any(read, axis=-1), posterior(pi_1, l1, loss(z, R, read)), 0.0)
    H = O @ inverse(root)
    rows = np.concatenate([H, (v + matvec(H, m))[..., None]], axis=-1)
    rows = forward(np.linalg.cholesky(R + np.asarray(omega_weight)[..., None, None] * Omega), rows)
    rows = np.sqrt(np.where(mu < NEGLIGIBLE, 0.0, mu))[..., None, None] * rows
    A, b = rows[..., :POSITION], rows[..., POSITION]
    vector, matrix = np.zeros_like(prior.m), np.zeros_like(prior.chol_P)
    vector[..., :POSITION] = matvec(transpose(A), b)
    matrix[..., :POSITION, :POSITION] = transpose(A) @ A
    return Contribution(Information(vector, matrix), mu)


def to_information(belief: Belief) -> Information:
    """y and Y of a belief: with the inverse root, Y = chol_P^-T chol_P^-1."""
    inverse_root = inverse(belief.chol_P)
    Y = transpose(inverse_root) @ inverse_root
    return Information(matvec(transpose(inverse_root), matvec(inverse_root, belief.m)), Y)


def to_belief(information: Information) -> Belief:
    """The belief of y and Y: Y = U U', chol_P = U^-T, m = chol_P chol_P' y; LinAlgError where Y is not definite.

    U is upper triangular, from the Cholesky factor of the matrix with the order of its states reversed.
    """
    y, Y = information
    chol_P = inverse(transpose(_upper(Y)))
    return Belief(matvec(chol_P, matvec(transpose(chol_P), y)), chol_P)


def is_definite(information: Information) -> Mask:
    """Where Y is so definite that `to_belief` has its belief, (...); at the edge of rounding no eigenvalue tells."""
    Y = information.matrix
    if _has_root(Y):
        return np.ones(Y.shape[:-2], dtype=np.bool_)
    return np.array([_has_root(each) for each in Y.reshape(-1, *Y.shape[-2:])]).reshape(Y.shape[:-2])


def _has_root(Y: Floats) -> bool:
    try:
        _upper(Y)
    except np.linalg.LinAlgError:
        return False
    return True


def _upper(Y: Floats) -> Floats:
    """U with Y = U U', upper triangular."""
    return np.linalg.cholesky(Y[..., ::-1, ::-1])[..., ::-1, ::-1]


def is_semidefinite(information: Information) -> Mask:
    """Where Y has no negative eigenvalue beyond rounding, as every sum and average of contributions has, (...)."""
    values = np.linalg.eigvalsh(information.matrix)
    return np.asarray(values[..., 0] >= -ROUNDING * values[..., -1])


# ---- information as one row of numbers, for whoever sends or averages it


def packed(information: Information) -> Floats:
    """Vector and upper triangle of the matrix, row by row, (..., n + n (n + 1) / 2)."""
    y, Y = information
    rows, columns = _triangle(y.shape[-1])
    return np.concatenate([y, Y[..., rows, columns]], axis=-1)


def unpacked(row: Floats, n: int = 4) -> Information:
    """The information of a packed row."""
    rows, columns = _triangle(n)
    Y = np.empty((*row.shape[:-1], n, n))
    Y[..., rows, columns] = row[..., n:]
    Y[..., columns, rows] = row[..., n:]
    return Information(row[..., :n], Y)


@cache
def _triangle(n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of an upper triangle, row by row: to find them anew costs more than what is done with them."""
    rows, columns = np.triu_indices(n)
    rows.setflags(write=False)
    columns.setflags(write=False)
    return rows, columns
