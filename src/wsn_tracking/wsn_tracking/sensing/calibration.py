"""What a node's radio does, from signal strengths at known distances."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.robust_fit import FAR, GAUSSIAN, HUBER

EXPONENTS = (0.5, 6.0)  # below: a wave guide; above: no indoor measurement says so
EXPONENT_MEAN, EXPONENT_STD = 2.0, 1.0  # what is known of n before any measurement: free space, loosely
MIN_SCALE = 1e-3  # [dB] far below any radio's resolution
MIN_POINTS = 3
PASSES = 100


class PathLoss(NamedTuple):
    """A radio reads p1_dbm - 10 n log10(d / d0) with standard deviation sigma_db."""

    p1_dbm: float  # at d0
    n: float
    sigma_db: float  # of the given values about the curve, at least MIN_SCALE
    count: int  # type: ignore[assignment]  # values used; tuple.count is never needed


def fit_path_loss(
    distances: ArrayLike, rssi_dbm: ArrayLike, weights: ArrayLike | None = None, d0: float = 1.0
) -> PathLoss:
    """Robust fit of the log-distance model (seed 000, section 2.2) to one node's values.

    distances (K,) [m], three-dimensional; rssi_dbm (K,); weights (K,) >= 0. With x = 10 log10(d / d0) it
    minimises sum w rho((y - P1 + n x) / s) + (n - 2)^2 / (2 * 1^2), rho Huber's, s from the median of the
    absolute residuals, by iteratively reweighted least squares: where the distances hardly differ, n stays
    near the 2 of free space instead of following the noise. n is kept within EXPONENTS. Values that are
    not finite, not at a positive distance or without weight are left out; TrackingError for fewer than
    MIN_POINTS.
    """
    d, y = np.broadcast_arrays(np.asarray(distances, np.float64), np.asarray(rssi_dbm, np.float64))
    w = np.ones(d.shape) if weights is None else np.broadcast_to(np.asarray(weights, np.float64), d.shape)
    use = np.isfinite(d) & np.isfinite(y) & np.isfinite(w) & (d > 0.0) & (w > 0.0)
    if np.count_nonzero(use) < MIN_POINTS:
        raise TrackingError(
            f'{np.count_nonzero(use)} of {d.size} signal strengths can be used for a calibration, at least '
            f'{MIN_POINTS} at known positive distances are expected'
        )
    x, y, w = 10.0 * np.log10(d[use] / d0), y[use], w[use]
    p1, n = _line(x, y, w, MIN_SCALE)
    for _ in range(PASSES):
        scale = _scale(y - p1 + n * x)
        size = np.abs(y - p1 + n * x) / scale
        before = p1, n
        p1, n = _line(x, y, w * np.minimum(1.0, HUBER / np.maximum(size, HUBER)), scale)
        if max(abs(p1 - before[0]), abs(n - before[1])) < 1e-9:
            break
    residual = y - p1 + n * x
    limit = FAR * _scale(residual)
    freedom = max(1.0 - 2.0 / residual.size, 1.0 / residual.size)  # two numbers were fitted
    variance = np.average(np.clip(residual, -limit, limit) ** 2, weights=w) / freedom
    return PathLoss(float(p1), float(n), max(float(np.sqrt(variance)), MIN_SCALE), int(residual.size))


def _line(x: Floats, y: Floats, w: Floats, scale: float) -> tuple[float, float]:
    """Weighted least squares of y = p1 - n x with the prior on n; `scale` is the deviation of y [dB]."""
    total = np.sum(w)
    x_mean, y_mean = np.sum(w * x) / total, np.sum(w * y) / total
    prior = (scale / EXPONENT_STD) ** 2
    slope = (prior * EXPONENT_MEAN - np.sum(w * (x - x_mean) * (y - y_mean))) / (prior + np.sum(w * (x - x_mean) ** 2))
    n = float(np.clip(slope, *EXPONENTS))
    return float(y_mean + n * x_mean), n


def _scale(residual: Floats) -> float:
    """Standard deviation of Gaussian residuals by their median size, indifferent to outliers."""
    return max(float(np.median(np.abs(residual))) * GAUSSIAN, MIN_SCALE)
