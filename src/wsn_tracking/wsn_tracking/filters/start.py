"""Where to start: the likelihood of the first epochs over a grid, moment-matched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.measurement import Function
from wsn_tracking.models.region import region_of

LONGEST = 1024  # cells along one side: of a corridor without end they are longer than it is wide
TINY = 1e-300  # least likelihood: an epoch may contradict another, it rules nothing out
ALONE = 30.0  # [m] how far off a target may be where all nodes are at one place: what a radio reaches indoors
Area = tuple[float, ...]  # as the parameter `area`: a rectangle or corners


class Sight(NamedTuple):
    """What one epoch tells of the position: z (N,), NaN where nothing was heard, of h with noise root std."""

    age: float  # [s] before the instant that is asked for, >= 0
    z: Floats
    h: Function
    noise: Function


def area_of(anchors: Anchors, margin: float = 0.25) -> Area:
    """The rectangle round the nodes, widened by a share of its longer side [m], at least by 1 m.

    One place, of one node or of all, says nothing of how large the field is: targets are then as far off as it reaches.
    """
    low, high = anchors.positions[:, :2].min(axis=0), anchors.positions[:, :2].max(axis=0)
    side = float((high - low).max())
    wider = max(margin * side, 1.0) if side > 0.0 else ALONE
    return (
        float(low[0]) - wider,
        float(low[1]) - wider,
        float(high[0]) + wider,
        float(high[1]) + wider,
    )


def likelihood_start(sights: Sequence[Sight], area: Area, speed_std: float, cells: int = 4096) -> Belief:
    """Belief over [x, y, vx, vy] from a flat prior over the area (see `region_of`) [m].

    The position is the mean and covariance of the grid posterior, widened by the cell; the velocity is
    N(0, speed_std^2) per axis [m/s]. Where the target was `age` seconds ago is N(0, (speed_std age)^2) off, for all
    nodes of that epoch alike: the epoch's likelihood is blurred as a whole, not the noise of its measurements.
    """
    floor = region_of(area)
    x_min, y_min, x_max, y_max = floor.box
    cell = float(max(np.sqrt((x_max - x_min) * (y_max - y_min) / cells), max(x_max - x_min, y_max - y_min) / LONGEST))
    x, y = _centres(x_min, x_max, cell), _centres(y_min, y_max, cell)
    grid = np.stack(np.meshgrid(x, y, indexing='ij'), axis=-1).reshape(-1, 2)
    log_p = np.zeros((x.size, y.size))
    for sight in sights:
        log_p += _blurred(log_likelihood(sight, grid).reshape(log_p.shape), x, y, speed_std * sight.age)
    p = np.exp(log_p - log_p.max()).ravel()
    if len(area) > 4 and (inside := floor.contains(grid)).any():
        p = np.where(inside, np.maximum(p, TINY), 0.0)
    p /= p.sum()
    mean = p @ grid
    d = grid - mean
    P = (p[:, None] * d).T @ d + cell**2 / 12.0 * np.eye(2)
    chol_P = np.zeros((4, 4))
    chol_P[:2, :2] = np.linalg.cholesky(P)
    chol_P[2:, 2:] = speed_std * np.eye(2)
    return Belief(np.concatenate([mean, np.zeros(2)]), chol_P)


def _centres(low: float, high: float, cell: float) -> Floats:
    """Middles of the cells between two ends; one cell where there is room for none."""
    return np.arange(low + cell / 2.0, high, cell) if cell / 2.0 < high - low else np.array([0.5 * (low + high)])


def log_likelihood(sight: Sight, grid: Floats) -> Floats:
    """Log likelihood of an epoch at positions (C, 2), but for a constant, (C,)."""
    std = sight.noise(grid)
    terms = 0.5 * ((sight.z - sight.h(grid)) / std) ** 2 + np.log(std)
    return -np.asarray(np.where(np.isnan(sight.z), 0.0, terms).sum(axis=-1))


def _blurred(log_p: Floats, x: Floats, y: Floats, way: float) -> Floats:
    """Mean of a likelihood (X, Y) over where the target may have been before a Gaussian way of `way` [m] per axis."""
    if way <= 0.0:
        return log_p
    p = np.exp(log_p - log_p.max())
    return np.asarray(np.log(np.maximum(_kernel(x, way) @ p @ _kernel(y, way).T, TINY)))


def _kernel(x: Floats, way: float) -> Floats:
    """Gaussian weights of all places x (X,) seen from each, (X, X), rows summing to one."""
    w = np.exp(-0.5 * ((x[:, None] - x) / way) ** 2)
    return np.asarray(w / w.sum(axis=-1, keepdims=True))
