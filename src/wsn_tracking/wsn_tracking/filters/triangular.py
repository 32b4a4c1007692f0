"""Forward substitution, batched: LAPACK where there are few matrices, all of them at once where there are many."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.linalg import large
from wsn_tracking.models.anchors import Floats


def forward(L: Floats, B: Floats) -> Floats:
    """L^-1 B for lower triangular L (..., n, n) and B (..., n, k)."""
    shape = np.broadcast_shapes(L.shape[:-2], B.shape[:-2])
    if not large(shape):
        return np.linalg.solve(L, B)
    X = np.broadcast_to(np.moveaxis(B, (-2, -1), (0, 1)), (*B.shape[-2:], *shape)).copy()
    rows = np.ascontiguousarray(np.moveaxis(L, (-2, -1), (0, 1)))
    for i in range(len(X)):
        for j in range(i):
            X[i] -= rows[i, j] * X[j]
        X[i] /= rows[i, i]
    return np.moveaxis(X, (0, 1), (-2, -1))


def inverse(L: Floats) -> Floats:
    """L^-1 of lower triangular L (..., n, n), lower triangular itself."""
    return np.tril(forward(L, np.broadcast_to(np.eye(L.shape[-1]), L.shape)))
