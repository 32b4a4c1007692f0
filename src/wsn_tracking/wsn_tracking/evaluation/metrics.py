"""Error measures over leading axes: one run is (K, 2), a Monte Carlo study (runs, estimators, K, 2).

An epoch whose error is NaN is a missing epoch: it is left out of every mean, and a mean of nothing is NaN.
"""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats

SINGULAR = 16.0 * float(np.finfo(np.float64).eps)  # a pivot below this share of its variance is rounding


def position_errors(means: Floats, truth: Floats) -> Floats:
    """Estimate minus truth in the plane, (..., K, 2) [m].

    means (..., K, n >= 2), states x and y first [m]; truth (..., K, 2 or 3) [m].
    """
    return np.asarray(means[..., :2] - truth[..., :2], dtype=np.float64)


def mean_known(values: Floats) -> Floats:
    """Mean over the last axis of what is not NaN, (..., K) -> (...); NaN where nothing is known."""
    known = ~np.isnan(values)
    count = known.sum(axis=-1)
    total = np.where(known, values, 0.0).sum(axis=-1)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))


def distances(errors: Floats) -> Floats:
    """Length of each error, (..., K, 2) -> (..., K) [m]."""
    return np.asarray(np.hypot(errors[..., 0], errors[..., 1]))


def rmse(errors: Floats) -> Floats:
    """Root of the mean squared distance, (..., K, 2) -> (...) [m]."""
    return np.asarray(np.sqrt(mean_known(np.sum(errors**2, axis=-1))))


def percentile(errors: Floats, percent: float) -> Floats:
    """Percentile of the distance, linear between order statistics, (..., K, 2) -> (...) [m]."""
    ordered = np.sort(distances(errors), axis=-1)  # NaN sorts to the end
    count = (~np.isnan(ordered)).sum(axis=-1)
    if ordered.shape[-1] == 0:
        return np.full(count.shape, np.nan)
    at = np.maximum(count - 1, 0) * (percent / 100.0)
    below = np.floor(at).astype(np.int64)
    above = np.minimum(below + 1, np.maximum(count - 1, 0))
    low = np.take_along_axis(ordered, below[..., None], axis=-1)[..., 0]
    high = np.take_along_axis(ordered, above[..., None], axis=-1)[..., 0]
    return np.asarray(low + (at - below) * (high - low))


def ei(errors: Floats) -> Floats:
    """Error indicator: mean of |ex| + |ey|, (..., K, 2) -> (...) [m] (seed 000, eq. 25).

    The document's mean over runs is a mean of this over the axis of the runs.
    """
    return mean_known(np.sum(np.abs(errors), axis=-1))


def esi(errors: Floats) -> Floats:
    """Error sum indicator: |error| of each axis summed so far, (..., K, 2) -> same [m] (seed 000, eq. 27).

    The last row is the value of the whole run; the document's sum over experiments is a sum over their axis.
    """
    return np.asarray(np.cumsum(np.where(np.isnan(errors), 0.0, np.abs(errors)), axis=-2))


def nees(errors: Floats, covariances: Floats) -> Floats:
    """Normalised estimation error squared e' P^-1 e, (..., d) and (..., d, d) -> (...).

    Its mean is d for a consistent filter (it is not divided by d). With P = L L' it is |L^-1 e|^2; factor and
    solve run together, column by column, so that a bad P in a batch spoils only its own value. NaN where
    P is NaN, singular or indefinite.
    """
    d = errors.shape[-1]
    shape = np.broadcast_shapes(errors.shape[:-1], covariances.shape[:-2])
    chol_P = np.zeros((*shape, d, d))
    w = np.zeros((*shape, d))
    with np.errstate(invalid='ignore', over='ignore'):
        for j in range(d):
            variance = covariances[..., j, j]
            pivot = variance - np.sum(chol_P[..., j, :j] ** 2, axis=-1)
            root = np.sqrt(np.where(pivot > d * SINGULAR * variance, pivot, np.nan))
            w[..., j] = (errors[..., j] - np.sum(chol_P[..., j, :j] * w[..., :j], axis=-1)) / root
            chol_P[..., j, j] = root
            known = np.sum(chol_P[..., j + 1 :, :j] * chol_P[..., j, None, :j], axis=-1)
            chol_P[..., j + 1 :, j] = (covariances[..., j + 1 :, j] - known) / root[..., None]
        return np.asarray(np.sum(w**2, axis=-1))
