"""Predict and update without QR, through Gram matrices: fewer and cheaper steps, at the square of the condition number.

Both are exact. Each result says whether its pivots (..., k) may be trusted; where not, `srckf` takes the QR form.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import gramian, large, matvec, product, transpose
from wsn_tracking.models.anchors import Floats, Mask

TRUST = 1e-5  # least share of a variance that what came before leaves unexplained: rounding grows to 1e-16 over it
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
        return _written_out(_trailing(A[..., :k]).copy())
    try:
        L = np.linalg.cholesky(A)[..., :k]
    except np.linalg.LinAlgError:
        L = np.full((*A.shape[:-1], k), np.nan)
    pivots, variances = L.diagonal(0, -2, -1).copy(), A.diagonal(0, -2, -1)[..., :k].copy()  # contiguous is faster
    return Root(L, pivots * pivots > TRUST * variances)


def _written_out(L: Floats) -> Root:
    """Column after column of a matrix (n, k, ...), which L takes the place of, on contiguous vectors over the batch."""
    k = L.shape[1]
    trusted = np.empty(L.shape[1:], dtype=np.bool_)
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


def _trailing(A: Floats) -> Floats:
    """Matrices (..., n, k) with their batch behind, (n, k, ...)."""
    return np.moveaxis(A, (-2, -1), (0, 1))


def predict(belief: Belief, F: Floats, chol_Q: Floats) -> tuple[Belief, Mask]:
    """Root of A A' + Q with A = F chol_P, and F m."""
    m, P = matvec(F, belief.m), gramian(product(F, belief.chol_P)) + gramian(chol_Q)
    root, trusted = cholesky(P, P.shape[-1])
    return Belief(m if m.ndim == root.ndim - 1 else np.broadcast_to(m, root.shape[:-1]), root), trusted


def condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> tuple[Belief, Mask]:
    """The posterior in information form over z = z_hat + O u + E w + v, with u, w ~ N(0, I) and v ~ N(0, R) diagonal.

    J = I + [E O]' R^-1 [E O] is the information of (w, u), b = [E O]' R^-1 (z - z_hat). With u in reverse order, the
    last block of the factor of J, inverted and transposed, is lower triangular and a root of the covariance of u:
    chol_P+ = chol_P L_uu^-T and m+ = m + chol_P+ (L^-1 b)_u. Both come with that factor, as rows b' and [0, chol_P]
    below J. A missing row has no information; columns of chol_P that no reading looks at stay as they are.
    """
    m, chol_P = prior
    rows, d = r
    k = rows.shape[-2] - 1
    innovation = z - rows[..., k, :]
    precision = np.reciprocal(root_R + TINY, out=np.empty(innovation.shape))
    np.copyto(innovation, 0.0, where=missing)
    np.copyto(precision, 0.0, where=missing)
    white = rows * precision[..., None, :]
    white[..., k, :] = innovation * precision
    L, trusted = _eliminated(white, chol_P[..., :d][..., ::-1])
    seen = L[..., k + 1 :, k - d :]
    root = np.empty(white.shape[:-2] + chol_P.shape[-2:])
    root[...] = chol_P
    root[..., :d] = seen[..., ::-1]
    return Belief(m + matvec(seen, L[..., k, k - d :]), root), trusted


def _eliminated(white: Floats, below: Floats) -> Root:
    """The factor of J = I + W W' and, as rows below, w' W' and [0, B] times its inverse transposed.

    white (..., k + 1, N): W and w' below it; below (..., n, d): B.
    """
    batch, (rows, N), (n, d) = white.shape[:-2], white.shape[-2:], below.shape[-2:]
    k = rows - 1
    if large(batch):
        L = np.zeros((rows + n, k, *batch))
        L[:rows] = _trailing(white @ transpose(white[..., :k, :]))
        L[range(k), range(k)] += 1.0
        L[rows:, k - d :] = _trailing(below)
        return _written_out(L)
    frame = _frame(rows + n, N)
    G = np.empty(batch + frame.shape)
    G[...] = frame
    G[..., :rows, :N] = white
    G[..., rows:, N + k - d : N + k] = below
    return cholesky(gramian(G), k)


@lru_cache
def _frame(rows: int, N: int) -> Floats:
    """[0, I] (rows, N + rows): with I beside them, rows have a Gram matrix that is definite, whatever they are."""
    return np.eye(rows, N + rows, N)
