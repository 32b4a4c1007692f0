"""Predict and update without QR, through Gram matrices: fewer and cheaper steps, at the square of the condition number.

Both are exact. Each result says whether it may be trusted; where not, `srckf` takes the QR form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import matvec, transpose
from wsn_tracking.models.anchors import Floats, Mask

TRUST = 1e-5  # least share of a variance that what came before leaves unexplained: rounding grows to 1e-16 over it
WRITTEN_OUT = 64  # matrices from which on steps over all of them at once are faster than LAPACK one by one
AMPLE = 1e12  # more than the squared norm of any row of what stands below a matrix
TINY = 1e-200  # least variance that is told apart from zero


class Root(NamedTuple):
    """What `cholesky` gives, and whether each matrix of the batch is as good as if QR had given it (...)."""

    L: Floats
    trusted: Mask


def cholesky(A: Floats) -> Root:
    """L (..., n, k) of A (..., n, k), n >= k: the factor of the first k rows, and the others times its inverse transposed.

    That is the first k columns of the factor of any positive definite matrix that begins with A. NaN where the first k
    rows are not positive definite.
    """
    L = _written_out(A) if A.ndim > 2 and A[..., 0, 0].size >= WRITTEN_OUT else _by_lapack(A)
    pivots = L.diagonal(0, -2, -1)
    return Root(L, np.logical_and.reduce(pivots * pivots > TRUST * A.diagonal(0, -2, -1), axis=-1))


def _by_lapack(A: Floats) -> Floats:
    n, k = A.shape[-2:]
    square = A
    if n > k:
        square = np.zeros((*A.shape[:-1], n))
        square[...] = AMPLE * np.eye(n)
        square[..., :k] = A
    try:
        return np.linalg.cholesky(square)[..., :k]
    except np.linalg.LinAlgError:
        return np.full(A.shape, np.nan)


def _written_out(A: Floats) -> Floats:
    """The same, column after column, on contiguous vectors over the batch."""
    L = np.moveaxis(A, (-2, -1), (0, 1)).copy()
    with np.errstate(invalid='ignore', divide='ignore'):
        for j in range(L.shape[1]):
            for k in range(j):
                L[j:, j] -= L[j:, k] * L[j, k]
            L[j, j] = np.sqrt(L[j, j])
            L[j + 1 :, j] /= L[j, j]
            L[j, j + 1 :] = 0.0
    return np.moveaxis(L, (0, 1), (-2, -1))


def predicted_root(propagated: Floats, chol_Q: Floats) -> Root:
    """Root of A A' + Q for A = F chol_P (..., n, n)."""
    return cholesky(propagated @ transpose(propagated) + chol_Q @ transpose(chol_Q))


def condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> tuple[Belief, Mask]:
    """The posterior in information form over z = z_hat + O u + E w + v, with u, w ~ N(0, I) and v ~ N(0, R) diagonal.

    J = I + [E O]' R^-1 [E O] is the information of (w, u), b = [E O]' R^-1 (z - z_hat). With u in reverse order, the
    last block of the factor of J, inverted and transposed, is lower triangular and a root of the covariance of u:
    chol_P+ = chol_P L_uu^-T and m+ = m + chol_P+ (L^-1 b)_u. Both come with that factor, as rows b' and [0, chol_P] below
    J. A missing row has no information; columns of chol_P that no reading looks at stay as they are.
    """
    d, n = r.O.shape[-1], prior.m.shape[-1]
    k = r.E.shape[-1] + d
    information = np.where(missing, 0.0, 1.0 / (root_R * root_R + TINY))
    innovation = np.where(missing, 0.0, z - r.z_hat)
    batch = innovation.shape[:-1]
    deviations = np.empty((*batch, k + 1, innovation.shape[-1]))
    deviations[..., : k - d, :] = transpose(r.E)
    deviations[..., k - d : k, :] = transpose(r.O)[..., ::-1, :]
    deviations[..., k, :] = innovation
    A = np.zeros((*batch, k + 1 + n, k))
    A[..., : k + 1, :] = (deviations * information[..., None, :]) @ transpose(deviations[..., :k, :])
    A[..., :k, :] += np.eye(k)
    A[..., k + 1 :, k - d :] = prior.chol_P[..., :d][..., ::-1]
    L, trusted = cholesky(A)
    seen = L[..., k + 1 :, k - d :]
    root = np.empty((*batch, n, n))
    root[...] = prior.chol_P
    root[..., :d] = seen[..., ::-1]
    return Belief(prior.m + matvec(seen, L[..., k, k - d :]), root), trusted
