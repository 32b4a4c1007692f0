"""Predict and update without QR, through Gram matrices: fewer and cheaper steps, at the square of the condition number.

Both are exact. Each result says whether it may be trusted; where not, `srckf` takes the QR form.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.models.anchors import Floats, Mask

TRUST = 1e-5  # least share of a variance that what came before leaves unexplained: rounding grows to 1e-16 over it
WRITTEN_OUT = 64  # matrices from which on steps over all of them at once are faster than LAPACK one by one


class Root(NamedTuple):
    """A Cholesky factor (..., n, n), NaN where there is none, and whether it is as good as QR's (...)."""

    L: Floats
    trusted: Mask


def cholesky(A: Floats, trusting: int | None = None) -> Root:
    """L with L L' = A (..., n, n), judged by its first `trusting` pivots (all)."""
    if A.ndim > 2 and A[..., 0, 0].size >= WRITTEN_OUT:
        L = _written_out(A)
    else:
        try:
            L = np.linalg.cholesky(A)
        except np.linalg.LinAlgError:
            L = np.full(A.shape, np.nan)
    pivots, whole = L.diagonal(0, -2, -1)[..., :trusting], A.diagonal(0, -2, -1)[..., :trusting]
    return Root(L, (pivots * pivots > TRUST * whole).all(axis=-1))


def _written_out(A: Floats) -> Floats:
    """The same, column after column, on contiguous vectors over the batch."""
    n = A.shape[-1]
    L = np.moveaxis(A, (-2, -1), (0, 1)).copy()
    with np.errstate(invalid='ignore', divide='ignore'):
        for j in range(n):
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

    J = I + [E O]' R^-1 [E O] is the information of (w, u), b = [E O]' R^-1 (z - z_hat). The last block of its
    Cholesky factor is a root of the information of u alone: with u in reverse order, its inverse transposed is lower
    triangular, hence chol_P+ = chol_P L_uu^-T and m+ = m + chol_P+ (L^-1 b)_u. The row b' below J gives (L^-1 b)'
    in the same factor; what stands at its end only has to keep that positive. A missing row has no information.
    """
    d = r.O.shape[-1]
    with np.errstate(divide='ignore'):
        information = np.where(missing, 0.0, 1.0 / (root_R * root_R))
    innovation = np.where(missing, 0.0, z - r.z_hat)
    odd = transpose(r.O)[..., ::-1, :]
    shape = (*innovation.shape[:-1], *odd.shape[-2:])  # z may have axes that the belief lacks
    odd, even = (rows if rows.shape == shape else np.broadcast_to(rows, shape) for rows in (odd, transpose(r.E)))
    rows = np.concatenate([even, odd, innovation[..., None, :]], axis=-2)
    J = (rows * information[..., None, :]) @ transpose(rows) + _eye(rows.shape[-2])
    L, trusted = cholesky(J, trusting=-1)
    return _posterior(prior, L[..., -d - 1 :, -d - 1 :], d), trusted


def _posterior(prior: Belief, L: Floats, d: int) -> Belief:
    """Solve for the first d columns of the root, last one first; the others, which no reading looks at, stay."""
    m, S = prior
    batch = L.shape[:-2]
    root = np.array(np.broadcast_to(S, (*batch, *S.shape[-2:])) if S.ndim < L.ndim or S.shape[:-2] != batch else S)
    for i in range(d):
        column = root[..., d - 1 - i]
        for j in range(i):
            column -= root[..., d - 1 - j] * L[..., i, j, None]
        column /= L[..., i, i, None]
        m = m + column * L[..., d, i, None]
    return Belief(m, root)


@lru_cache
def _eye(n: int) -> Floats:
    return np.eye(n)
