"""Where to start: the likelihood of the first epochs over a grid, moment-matched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.measurement import Function

Area = tuple[float, float, float, float]


class Sight(NamedTuple):
    """What one epoch tells of the position: z (N,), NaN where nothing was heard, of h with noise root std."""

    age: float  # [s] before the instant that is asked for, >= 0
    z: Floats
    h: Function
    noise: Function


def area_of(anchors: Anchors, margin: float = 0.25) -> Area:
    """The rectangle round the nodes, widened by a share of its longer side [m]."""
    low, high = anchors.positions[:, :2].min(axis=0), anchors.positions[:, :2].max(axis=0)
    wider = max(margin * float((high - low).max()), 1.0)
    return (
        float(low[0]) - wider,
        float(low[1]) - wider,
        float(high[0]) + wider,
        float(high[1]) + wider,
    )


def likelihood_start(sights: Sequence[Sight], area: Area, speed_std: float, cells: int = 4096) -> Belief:
    """Belief over [x, y, vx, vy] from a flat prior over the area (x_min, y_min, x_max, y_max) [m].

    The position is the mean and covariance of the grid posterior, widened by the cell; the velocity is
    N(0, speed_std^2) per axis [m/s]. A target that moves at that speed has blurred what it told `age`
    seconds ago: a range by at most its way since, which is added to the noise through the slope of h
    between neighbouring cells' readings (h(x + s) - h(x) along both axes).
    """
    x_min, y_min, x_max, y_max = area
    cell = np.sqrt((x_max - x_min) * (y_max - y_min) / cells)
    x = np.arange(x_min + cell / 2.0, x_max, cell)
    y = np.arange(y_min + cell / 2.0, y_max, cell)
    grid = np.stack(np.meshgrid(x, y, indexing='ij'), axis=-1).reshape(-1, 2)
    log_p = np.zeros(len(grid))
    for sight in sights:
        z_hat = sight.h(grid)
        variance = sight.noise(grid) ** 2
        way = speed_std * sight.age
        if way > 0.0:
            for step in ((way, 0.0), (0.0, way)):
                variance = variance + (sight.h(grid + step) - z_hat) ** 2
        terms = (sight.z - z_hat) ** 2 / variance + np.log(variance)
        log_p -= 0.5 * np.where(np.isnan(sight.z), 0.0, terms).sum(axis=-1)
    p = np.exp(log_p - log_p.max())
    p /= p.sum()
    mean = p @ grid
    d = grid - mean
    P = (p[:, None] * d).T @ d + cell**2 / 12.0 * np.eye(2)
    chol_P = np.zeros((4, 4))
    chol_P[:2, :2] = np.linalg.cholesky(P)
    chol_P[2:, 2:] = speed_std * np.eye(2)
    return Belief(np.concatenate([mean, np.zeros(2)]), chol_P)
