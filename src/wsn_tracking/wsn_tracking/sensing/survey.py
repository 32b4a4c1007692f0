"""A survey: what every node read of a target at known places, one row a place."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio import MIN_RANGE

CELL = 0.25  # [m] readings within a square of this side are one place
MOST_PLACES = 150  # a fit takes the third power of their number; more make the squares larger
GROWTH = 1.2


class Readings(NamedTuple):
    """Single readings of a moving target, one row each."""

    positions: Floats  # (M, 3) [m] of the target
    node_ids: NDArray[np.int64]  # (M,)
    values: Floats  # (M,) [dBm], or range [m]


class Survey(NamedTuple):
    """Readings gathered by place; NaN and a count of 0 where a node heard nothing there."""

    ids: NDArray[np.int64]  # (N,) nodes, ascending
    points: Floats  # (K, 2) [m]
    distances: Floats  # (K, N) [m], three-dimensional, mean over the readings
    values: Floats  # (K, N) mean signal strength [dBm], or median of range minus distance [m]
    scatter: Floats  # (K, N) standard deviation of the readings at the place; NaN: not known
    counts: Floats  # (K, N) readings; infinity: so many that nobody has counted them

    @property
    def known(self) -> NDArray[np.bool_]:
        """(K, N) where a node has a usable value."""
        finite = np.isfinite(self.distances) & np.isfinite(self.values)
        return finite & (self.distances > 0.0) & (self.counts > 0.0)


def check(survey: Survey) -> Survey:
    """Itself, or TrackingError for one that tells nothing."""
    if not np.any(survey.known):
        raise TrackingError(
            f'the survey of nodes {survey.ids.tolist()} holds no usable value at any of its {len(survey.points)} '
            'places: give a recording with truth in which its nodes are heard'
        )
    return survey


def survey_of(readings: Readings, anchors: Anchors, *, ranges: bool = False, cell: float = CELL) -> Survey:
    """Readings gathered in squares of side `cell` [m]; larger ones where there would be more than MOST_PLACES.

    Signal strengths are averaged over a place, and the logarithms of their distances. Of ranges, the distance is
    taken off first and the median kept: walls make some of them far too long. What the distance changes within a
    place is taken off as well, by one slope for all nodes. Readings of nodes that are not among the anchors, or
    that are not finite, are left out.
    """
    rows = anchors.rows(readings.node_ids)
    use = (rows >= 0) & np.isfinite(readings.values) & np.all(np.isfinite(readings.positions), axis=1)
    positions, rows, values = readings.positions[use], rows[use], readings.values[use]
    if not values.size:
        raise TrackingError(
            f'none of {use.size} readings can be used for a calibration: finite values of the nodes '
            f'{anchors.ids.tolist()} at known places are expected'
        )
    places = _places(positions[:, :2], cell)
    away = np.maximum(np.linalg.norm(positions - anchors.positions[rows], axis=1), MIN_RANGE)
    K, N = int(places.max()) + 1, anchors.ids.size
    points = np.stack([_mean(places, positions[:, i], K) for i in (0, 1)], axis=-1)
    at = places * N + rows
    counts = np.bincount(at, minlength=K * N).astype(np.float64)
    x, y = (away, values - away) if ranges else (np.log(away), values)
    x_mean = _mean(at, x, K * N)
    level = y - _slope(rows, x, y) * (x - x_mean[at])
    middle = (_median if ranges else _mean)(at, level, K * N)
    distances = x_mean if ranges else np.exp(x_mean)
    table = (column.reshape(K, N) for column in (distances, middle, _scatter(at, level, middle, counts), counts))
    return check(Survey(anchors.ids, points, *table))


def survey_of_places(
    anchors: Anchors, places: ArrayLike, values: ArrayLike, scatter: ArrayLike, counts: ArrayLike
) -> Survey:
    """A survey that was made place by place: places (K, 3) [m]; values, scatter and counts (K, N)."""
    places = np.asarray(places, dtype=np.float64)
    distances = np.linalg.norm(places[:, None] - anchors.positions, axis=-1)
    table = (np.asarray(column, dtype=np.float64) for column in (values, scatter, counts))
    return check(Survey(anchors.ids, places[:, :2], distances, *table))


def _slope(rows: NDArray[np.int64], x: Floats, y: Floats) -> float:
    """Change of y with x, the same for all nodes, by least squares; 0 where x does not change."""
    size = int(rows.max()) + 1
    dx, dy = x - _mean(rows, x, size)[rows], y - _mean(rows, y, size)[rows]
    total = float(dx @ dx)
    return float(dx @ dy) / total if total > 0.0 else 0.0


def _places(xy: Floats, cell: float) -> NDArray[np.int64]:
    """Number of the square that each (M, 2) position is in."""
    while True:
        squares, numbers = np.unique(np.floor(xy / cell), axis=0, return_inverse=True)
        if len(squares) <= MOST_PLACES:
            return np.asarray(numbers, dtype=np.int64).reshape(-1)
        cell *= GROWTH


def _mean(at: NDArray[np.int64], values: Floats, size: int) -> Floats:
    """Mean of the values of each group; NaN for an empty one."""
    counts = np.bincount(at, minlength=size)
    with np.errstate(invalid='ignore'):
        return np.asarray(np.bincount(at, values, minlength=size) / counts)


def _median(at: NDArray[np.int64], values: Floats, size: int) -> Floats:
    """Median of the values of each group; NaN for an empty one."""
    out = np.full(size, np.nan)
    order = np.argsort(at, kind='stable')
    groups, begins = np.unique(at[order], return_index=True)
    for group, part in zip(groups.tolist(), np.split(values[order], begins[1:]), strict=True):
        out[group] = np.median(part)
    return out


def _scatter(at: NDArray[np.int64], values: Floats, middle: Floats, counts: Floats) -> Floats:
    """Standard deviation of each group; NaN where fewer than two values tell none."""
    squares = np.bincount(at, (values - middle[at]) ** 2, minlength=counts.size)
    with np.errstate(invalid='ignore', divide='ignore'):
        return np.where(counts > 1.0, np.sqrt(squares / (counts - 1.0)), np.nan)
