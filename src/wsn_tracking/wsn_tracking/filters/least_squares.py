"""Position by least squares of ranges (seed 001, section 1.1): linear, with no first guess, batched."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats

COLLINEAR = 1e-3  # nodes whose scatter across a line is below this share of that along it lie on the line


def least_squares(positions: Floats, d: Floats, weights: Floats | None = None) -> Floats:
    """Positions (..., 2) [m] of targets at plane distances d (..., N) from nodes at positions (N, 2) or (..., N, 2).

    The circles |x - a_j|^2 = d_j^2 less that of node n, the last that was heard: A x = B with the rows
    A_j = 2 (a_j - a_n) and B_j = |a_j|^2 - |a_n|^2 - d_j^2 + d_n^2. NaN in d: not heard. NaN comes back where fewer
    than three nodes were heard, or where these lie on a line: two places fit then.

    `weights` (..., N), inverse variances of d_j^2: what all rows owe to node n is a common error, and the best estimate
    takes the weighted means of |a|^2 - d^2 and a in the place of that node's (generalised least squares).
    """
    heard = ~np.isnan(d)
    w = heard.astype(np.float64) if weights is None else np.where(heard, weights, 0.0)
    lead = _last(heard) if weights is None else w / np.maximum(w.sum(axis=-1, keepdims=True), 1e-300)
    # counted from a point among the nodes, so that squares of far coordinates do not swallow the digits
    origin = np.sum(lead[..., None] * positions, axis=-2)
    A = positions - origin[..., None, :]
    c = 0.5 * (np.sum(A * A, axis=-1) - np.square(np.where(heard, d, 0.0)))
    B = c - np.sum(lead * c, axis=-1)[..., None]
    WA = w[..., None] * A
    M, v = np.swapaxes(WA, -1, -2) @ A, np.sum(WA * B[..., None], axis=-2)
    xx, xy, yy = M[..., 0, 0], M[..., 0, 1], M[..., 1, 1]
    det = xx * yy - xy * xy
    usable = (heard.sum(axis=-1) >= 3) & (det > COLLINEAR * np.square(xx + yy))
    det = np.where(usable, det, np.nan)
    x = np.stack([yy * v[..., 0] - xy * v[..., 1], xx * v[..., 1] - xy * v[..., 0]], axis=-1) / det[..., None]
    return np.asarray(origin + x)


def _last(heard: Floats) -> Floats:
    """One at the last node that was heard, zero elsewhere, (..., N); zero throughout where there is none."""
    after = np.cumsum(heard[..., ::-1], axis=-1)[..., ::-1]
    return np.asarray((heard & (after == 1)).astype(np.float64))
