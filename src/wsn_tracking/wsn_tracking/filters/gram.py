"""Predict and update without QR, through Gram matrices: fewer and cheaper steps, at the square of the condition number.

Both are exact. Each result says whether its pivots (..., k) may be trusted; where not, `srckf` takes the QR form.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import large, matvec, transpose
from wsn_tracking.models.anchors import Floats, Mask

TRUST = 1e-5  # least share of a variance that what came before leaves unexplained: rounding grows to 1e-16 over it
AMPLE = 1e12  # more than the squared norm of any row of what stands below a matrix
TINY = 1e-100  # least deviation that is told apart from zero


class Root(NamedTuple):
    """What `cholesky` gives, and whether its pivots (..., k) are as good as if QR had given them."""

    L: Floats
    trusted: Mask


def cholesky(A: Floats, k: int) -> Root:
    """The first k columns of the factor of positive definite matrices A (..., n, n), or (..., n, k) where `large`.

    They are the factor of the first k rows, and the others times its inverse transposed. What is above the diagonal of
    A does not matter. NaN where there is no factor.
    """
    if large(A.shape[:-2]):
        return _written_out(A, k)
    try:
        L = np.linalg.cholesky(A)[..., :k]
    except np.linalg.LinAlgError:
        L = np.full((*A.shape[:-1], k), np.nan)
    pivots = L.diagonal(0, -2, -1)
    return Root(L, pivots * pivots > TRUST * A.diagonal(0, -2, -1)[..., :k])


def _written_out(A: Floats, k: int) -> Root:
    """Column after column, on contiguous vectors over the batch."""
    L = np.moveaxis(A[..., :k], (-2, -1), (0, 1)).copy()
    trusted = np.empty((k, *A.shape[:-2]), dtype=np.bool_)
    with np.errstate(invalid='ignore', divide='ignore'):
        for j in range(k):
            least = TRUST * L[j, j]
            for i in range(j):
                L[j:, j] -= L[j:, i] * L[j, i]
            np.greater(L[j, j], least, out=trusted[j])
            L[j, j] = np.sqrt(L[j, j])
            L[j + 1 :, j] /= L[j, j]
            L[j, j + 1 :] = 0.0
    return Root(np.moveaxis(L, (0, 1), (-2, -1)), np.moveaxis(trusted, 0, -1))


def predict(belief: Belief, F: Floats, chol_Q: Floats) -> tuple[Belief, Mask]:
    """Root of A A' + Q with A = F chol_P, and F m."""
    A, m = F @ belief.chol_P, matvec(F, belief.m)
    across = np.ascontiguousarray(transpose(A))  # of a transposed view, NumPy computes one triangle, slowly
    root, trusted = cholesky(A @ across + chol_Q @ transpose(chol_Q), A.shape[-1])
    return Belief(m if m.ndim == root.ndim - 1 else np.broadcast_to(m, root.shape[:-1]), root), trusted


def condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> tuple[Belief, Mask]:
    """The posterior in information form over z = z_hat + O u + E w + v, with u, w ~ N(0, I) and v ~ N(0, R) diagonal.

    J = I + [E O]' R^-1 [E O] is the information of (w, u), b = [E O]' R^-1 (z - z_hat). With u in reverse order, the
    last block of the factor of J, inverted and transposed, is lower triangular and a root of the covariance of u:
    chol_P+ = chol_P L_uu^-T and m+ = m + chol_P+ (L^-1 b)_u. Both come with that factor, as rows b' and [0, chol_P]
    below J. A missing row has no information; columns of chol_P that no reading looks at stay as they are.
    """
    d, n = r.d, prior.m.shape[-1]
    k = r.rows.shape[-2] - 1
    precision = np.where(missing, 0.0, 1.0 / (root_R + TINY))
    innovation = np.where(missing, 0.0, z - r.z_hat)
    batch = innovation.shape[:-1]
    white = np.empty((*batch, *r.rows.shape[-2:]))
    white[...] = r.rows
    white[..., k, :] = innovation
    white *= precision[..., None, :]
    frame = _frame(k, k if large(batch) else k + 1 + n, k + 1 + n)
    A = np.empty(batch + frame.shape)
    A[...] = frame
    J = A[..., : k + 1, :k]
    J += white @ transpose(white[..., :k, :])
    A[..., k + 1 :, k - d : k] = prior.chol_P[..., :d][..., ::-1]
    L, trusted = cholesky(A, k)
    seen = L[..., k + 1 :, k - d :]
    root = np.empty((*batch, n, n))
    root[...] = prior.chol_P
    root[..., :d] = seen[..., ::-1]
    return Belief(prior.m + matvec(seen, L[..., k, k - d :]), root), trusted


@lru_cache
def _frame(k: int, columns: int, rows: int) -> Floats:
    """The information of the prior, and below it what keeps the whole matrix positive definite."""
    return np.diag([1.0] * k + [AMPLE] * (rows - k))[:, :columns]
