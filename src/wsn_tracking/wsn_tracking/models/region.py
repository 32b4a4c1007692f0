"""Where a target can be: a rectangle, or a floor of any shape, with the holes and walls that it has.

A region is one or more rings of corners; a point is inside where a ray from it crosses an odd number of edges. So the
first ring is the outline, further ones within it are what it leaves out.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import FURTHEST, Floats, Mask

INWARD = 1e-6  # [m] what is brought back lies this far inside, so that it counts as inside
SAME = 1e-9  # [m] corners that are no further apart are one
MAX_PAIRS = 2**20  # of points and edges that are looked at in one go


class Region(NamedTuple):
    """Edges of all rings, (E, 2) [m] each: from `start` to `end`."""

    start: Floats
    end: Floats

    @property
    def box(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max [m]."""
        low, high = self.start.min(axis=0), self.start.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def contains(self, points: ArrayLike) -> Mask:
        """Whether points (..., 2) [m] are inside, (...); those on an edge may be either, NaN is not."""
        p = np.asarray(points, dtype=np.float64)
        flat = p.reshape(-1, 2)
        flat = np.where(np.isfinite(flat).all(axis=-1, keepdims=True), flat, self.start.min() - 1.0)
        inside = [_odd(block, self) for block in _blocks(flat, self.start.shape[0])]
        return np.concatenate(inside).reshape(p.shape[:-1])

    def nearest(self, points: ArrayLike) -> Floats:
        """The points (..., 2) [m] themselves where they are inside, else the nearest inside."""
        p = np.asarray(points, dtype=np.float64)
        flat = np.array(p.reshape(-1, 2))
        outside = ~self.contains(flat) & np.isfinite(flat).all(axis=-1)
        if outside.any():
            blocks = _blocks(flat[outside], self.start.shape[0])
            flat[outside] = np.concatenate([_brought_in(block, self) for block in blocks])
        return flat.reshape(p.shape)

    def crossed(self, before: ArrayLike, after: ArrayLike) -> Mask:
        """Whether the straight way from points (..., 2) to points (..., 2) crosses an edge, (...)."""
        a, b = np.broadcast_arrays(np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64))
        ways = np.stack([a.reshape(-1, 2), b.reshape(-1, 2)], axis=1)
        found = [_meets(block, self) for block in _blocks(ways, self.start.shape[0])]
        return np.concatenate(found).reshape(a.shape[:-1])


def region(rings: Sequence[ArrayLike]) -> Region:
    """The region of rings (V, 2) [m], V >= 3; corners that are told twice, as by a ring that closes, are one.

    Raises TrackingError for a ring of fewer corners, of no area, or whose coordinates are no numbers.
    """
    starts, ends = [], []
    for number, ring in enumerate(rings, 1):
        corners = np.asarray(ring, dtype=np.float64)
        if corners.ndim != 2 or corners.shape[-1] != 2 or not np.all(np.abs(corners) <= FURTHEST):
            raise TrackingError(
                f'ring {number} of a region: expected corners x, y [m] that are finite numbers of at most {FURTHEST:g}'
            )
        corners = corners[np.any(np.abs(corners - np.roll(corners, -1, axis=0)) > SAME, axis=1)]
        following = np.roll(corners, -1, axis=0)
        (x, y), (x_next, y_next) = (corners - corners[:1]).T, (following - corners[:1]).T
        twice = float(np.sum(x * y_next - x_next * y))
        if corners.shape[0] < 3 or abs(twice) < 1e-12:
            raise TrackingError(f'ring {number} of a region has {corners.shape[0]} corners and no area: expected three')
        starts.append(corners)
        ends.append(following)
    if not starts:
        raise TrackingError('a region has no ring: expected its outline')
    return Region(np.concatenate(starts), np.concatenate(ends))


@cache
def region_of(area: tuple[float, ...]) -> Region:
    """The region of a parameter: x_min, y_min, x_max, y_max of a rectangle, or x, y of three or more corners.

    Raises TrackingError for anything else.
    """
    if len(area) == 4 and area[0] < area[2] and area[1] < area[3]:
        x_min, y_min, x_max, y_max = area
        return region([[(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)]])
    if len(area) >= 6 and len(area) % 2 == 0:
        return region([np.array(area).reshape(-1, 2)])
    raise TrackingError(
        f'`area` is {list(area)}: expected x_min, y_min, x_max, y_max with min < max, or x, y of three or more corners'
    )


def kept_inside(points: Floats, area: tuple[float, ...]) -> Floats:
    """Points (..., 2) [m] brought into an area where there is one (see `region_of`)."""
    if not area:
        return points
    if len(area) == 4:
        return np.asarray(np.minimum(np.maximum(points, area[:2]), area[2:]))
    return region_of(area).nearest(points)


def _blocks(points: Floats, edges: int) -> Sequence[Floats]:
    size = max(MAX_PAIRS // edges, 1)
    return [points[i : i + size] for i in range(0, points.shape[0], size)] or [points]


def _odd(p: Floats, r: Region) -> Mask:
    """Whether a ray to the right of points (P, 2) crosses an odd number of edges."""
    x, y = p[:, 0, None], p[:, 1, None]
    between = (r.start[:, 1] > y) != (r.end[:, 1] > y)
    rise = np.where(between, r.end[:, 1] - r.start[:, 1], 1.0)
    left = x < r.start[:, 0] + (y - r.start[:, 1]) * (r.end[:, 0] - r.start[:, 0]) / rise
    return np.asarray(np.sum(between & left, axis=-1) % 2 == 1)


def _brought_in(p: Floats, r: Region) -> Floats:
    """The nearest points inside for points (P, 2) outside."""
    way = r.end - r.start
    share = np.sum((p[:, None] - r.start) * way, axis=-1) / np.sum(way**2, axis=-1)
    feet = r.start + np.clip(share, 0.0, 1.0)[..., None] * way
    foot = feet[np.arange(p.shape[0]), np.argmin(np.sum((feet - p[:, None]) ** 2, axis=-1), axis=-1)]
    inward: Floats = foot.copy()
    open_ = np.ones(p.shape[0], dtype=bool)
    for dx, dy in itertools.product((0.0, INWARD, -INWARD), repeat=2):  # to whichever side of the border is inside
        tried = foot + np.array([dx, dy])
        found = open_ & r.contains(tried)
        inward[found], open_ = tried[found], open_ & ~found
    return inward


def _meets(ways: Floats, r: Region) -> Mask:
    """Whether ways (P, 2, 2), from and to, meet an edge."""
    a, b = ways[:, None, 0], ways[:, None, 1]
    apart = _side(r.start, r.end, a) * _side(r.start, r.end, b) < 0.0
    astride = _side(a, b, r.start) * _side(a, b, r.end) < 0.0
    return np.asarray(np.any(apart & astride, axis=-1))


def _side(a: Floats, b: Floats, p: Floats) -> Floats:
    """Positive where p lies left of the way from a to b."""
    return np.asarray(
        (b[..., 0] - a[..., 0]) * (p[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (p[..., 0] - a[..., 0])
    )
