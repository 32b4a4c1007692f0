"""The one primitive of square-root filtering, and triangular solves, batched over leading axes."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from wsn_tracking.models.anchors import Floats, Mask

WRITTEN_OUT = 64  # matrices from which on steps over all of them at once are faster than LAPACK one by one


def large(batch: tuple[int, ...]) -> bool:
    """Whether steps over all matrices of a batch at once are faster than LAPACK one by one."""
    return bool(batch) and math.prod(batch) >= WRITTEN_OUT


def every(mask: Mask) -> bool:
    """Whether a mask is true throughout: of a small one, its bytes tell in a tenth of the time of `all`."""
    return 0 not in mask.tobytes()


def some(mask: Mask) -> bool:
    """Whether a mask is true anywhere."""
    return 1 in mask.tobytes()


def transpose(A: Floats) -> Floats:
    """Swap the last two axes."""
    return A.swapaxes(-1, -2)


@lru_cache
def identity(n: int) -> Floats:
    """I (n, n), made once: not to be written to."""
    eye = np.eye(n)
    eye.flags.writeable = False
    return eye


def tria(A: Floats) -> Floats:
    """Lower triangular L (..., n, n) with L L' = A A' and a non-negative diagonal; A (..., n, k), k >= n.

    From the QR factors of A', so that A A' is never formed (seed 000, eq. 9, 15 and 19).
    """
    R = np.asarray(np.linalg.qr(transpose(A), mode='r'))
    diagonal = np.diagonal(R, axis1=-2, axis2=-1)
    return transpose(R * np.where(diagonal < 0.0, -1.0, 1.0)[..., None])


def solve(L: Floats, b: Floats) -> Floats:
    """L^-1 b for matrices L (..., n, n) and vectors b (..., n)."""
    return np.linalg.solve(L, b[..., None])[..., 0]


def product(A: Floats, B: Floats) -> Floats:
    """A B for matrices A (..., m, k) and B (..., k, n): of two alone, `dot` takes a third of the time of `@`."""
    return A.dot(B) if A.ndim == B.ndim == 2 else A @ B


def gramian(A: Floats) -> Floats:
    """A A' for matrices A (..., n, k): with a transposed view, NumPy would compute one triangle, slowly."""
    return product(A, np.ascontiguousarray(transpose(A)))


def matvec(A: Floats, b: Floats) -> Floats:
    """A b for matrices A (..., m, n) and vectors b (..., n)."""
    if A.ndim == 2:
        return b.dot(A.T) if b.ndim <= A.ndim else b @ A.T
    return (A @ b[..., None])[..., 0]
