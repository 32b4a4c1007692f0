"""Predict and update without QR, through Gram matrices: fewer and cheaper steps, at the square of the condition number.

Both are exact. Each result says whether it may be trusted; where not, `srckf` takes the QR form.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import matvec, transpose
from wsn_tracking.models.anchors import Floats, Mask

TRUST = 1e-5  # least share of a variance that what came before leaves unexplained: rounding grows to 1e-16 over it
WRITTEN_OUT = 64  # matrices from which on steps over all of them at once are faster than LAPACK one by one
AMPLE = 1e12  # [m^2] more than any variance


class Root(NamedTuple):
    """A Cholesky factor (..., n, n), NaN where there is none, and whether it is as good as QR's (...)."""

    L: Floats
    trusted: Mask


def cholesky(A: Floats, columns: int) -> Root:
    """The first columns of L with L L' = A (..., n, n); of the others nothing is promised. A's upper half is not read."""
    if A.ndim > 2 and A[..., 0, 0].size >= WRITTEN_OUT:
        L = _written_out(A, columns)
    else:
        try:
            L = np.linalg.cholesky(A)
        except np.linalg.LinAlgError:
            L = np.full(A.shape, np.nan)
    pivots, variances = (X.diagonal(0, -2, -1)[..., :columns] for X in (L, A))
    return Root(L, np.logical_and.reduce(pivots * pivots > TRUST * variances, axis=-1))


def _written_out(A: Floats, columns: int) -> Floats:
    """The same, column after column, on contiguous vectors over the batch."""
    L = np.moveaxis(A, (-2, -1), (0, 1)).copy()
    with np.errstate(invalid='ignore', divide='ignore'):
        for j in range(columns):
            for k in range(j):
                L[j:, j] -= L[j:, k] * L[j, k]
            L[j, j] = np.sqrt(L[j, j])
            L[j + 1 :, j] /= L[j, j]
            L[j, j + 1 :] = 0.0
    return np.moveaxis(L, (0, 1), (-2, -1))


def predicted_root(propagated: Floats, chol_Q: Floats) -> Root:
    """Root of A A' + Q for A = F chol_P (..., n, n)."""
    return cholesky(propagated @ transpose(propagated) + chol_Q @ transpose(chol_Q), propagated.shape[-1])


def condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> tuple[Belief, Mask]:
    """The posterior in information form over z = z_hat + O u + E w + v, with u, w ~ N(0, I) and v ~ N(0, R) diagonal.

    J = I + [E O]' R^-1 [E O] is the information of (w, u), b = [E O]' R^-1 (z - z_hat). With u in reverse order, the
    last block of its Cholesky factor, inverted and transposed, is lower triangular and a root of the covariance of u:
    chol_P+ = chol_P L_uu^-T and m+ = m + chol_P+ (L^-1 b)_u. Both stand in the factor of [[J, .], [b', .], [chol_P, .]]
    below that of J. A missing row has no information. Columns of chol_P that no reading looks at stay as they are.
    """
    d, e, n = r.O.shape[-1], r.E.shape[-1], prior.m.shape[-1]
    with np.errstate(divide='ignore'):
        information = np.where(missing, 0.0, 1.0 / (root_R * root_R))
    innovation = np.where(missing, 0.0, z - r.z_hat)
    odd, even, batch = transpose(r.O)[..., ::-1, :], transpose(r.E), innovation.shape[:-1]
    if batch != odd.shape[:-2]:  # z may have axes that the belief lacks
        odd, even = (np.broadcast_to(rows, (*batch, *rows.shape[-2:])) for rows in (odd, even))
    rows = np.concatenate([even, odd, innovation[..., None, :]], axis=-2)
    J = np.empty((*batch, e + d + 1 + n, e + d + 1 + n))
    J[...] = _below(e + d + 1, n)
    J[..., : e + d + 1, : e + d + 1] += (rows * information[..., None, :]) @ transpose(rows)
    J[..., e + d + 1 :, e : e + d] = prior.chol_P[..., :d][..., ::-1]
    L, trusted = cholesky(J, e + d)
    seen, whitened = L[..., e + d + 1 :, e : e + d], L[..., e + d, e : e + d]
    root = np.empty((*batch, n, n))
    root[...] = prior.chol_P
    root[..., :d] = seen[..., ::-1]
    return Belief(prior.m + matvec(seen, whitened), root), trusted


@lru_cache
def _below(informed: int, n: int) -> Floats:
    """What is on the diagonal: the information of the prior, and what keeps the rest of the matrix positive."""
    return np.diag([1.0] * informed + [AMPLE] * n)
