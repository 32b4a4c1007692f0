"""Where particles of a person can be: which have left, and where new ones are placed (seed 003, section 3.4)."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.particle import Cloud, moments, taken
from wsn_tracking.filters.resampling import Resampler
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.region import Region
from wsn_tracking.models.walk import Walk, X, Y, beyond, drawn

ABOUT = 0.8  # share of the places of a new start that are about where he may have gone meanwhile

Area = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]


class Places:
    """An area, and a floor within it where there is one, beyond which nobody is and through whose edges nobody walks.

    walk: of who is placed; links: rows behind the states of the walk, offsets of which nothing is known (0).
    """

    def __init__(self, area: Area, floor: Region | None, walk: Walk, links: int = 0) -> None:
        self.area, self._floor, self._walk, self._links = area, floor, walk, links

    def left(self, before: Floats, after: Floats) -> Mask:
        """Which particles (..., S, P) have left the area or the floor, or walked through a wall, (..., P)."""
        out = beyond(after, self.area)
        if self._floor is None:
            return out
        ways = [np.swapaxes(s[..., X : Y + 1, :], -1, -2) for s in (before, after)]
        return np.asarray(out | ~self._floor.contains(ways[1]) | self._floor.crossed(*ways))

    def anywhere(self, runs: tuple[int, ...], n: int, generator: np.random.Generator) -> Floats:
        """n particles (..., S, n) of each run."""
        x_min, y_min, x_max, y_max = self.area
        corner, size = np.array([[x_min], [y_min]]), np.array([[x_max - x_min], [y_max - y_min]])
        places: Floats = corner + size * generator.random((*runs, 2, n))
        if self._floor is not None:
            places = _rather_inside(places, self._floor)
        s = drawn(self._walk, places, generator)
        if not self._links:
            return s
        return np.concatenate([s, np.zeros((*runs, self._links, n))], axis=-2)

    def about(
        self, candidates: Floats, near: Cloud, thin: Mask, resample: Resampler, generator: np.random.Generator
    ) -> Floats:
        """The candidates (..., S, n), where `thin` with a share ABOUT of their places drawn from a smoothed cloud.

        The kernel is Gaussian, with Silverman's bandwidth for two dimensions.
        """
        w = near.w
        places, m = near.s[..., X : Y + 1, :], round(ABOUT * candidates.shape[-1])
        std = np.sqrt(np.maximum(np.diagonal(moments(places, w)[1], axis1=-2, axis2=-1), 0.0))
        drawn_ = taken(places, resample(w, m, generator))
        drawn_ = drawn_ + (w.shape[-1] ** (-1.0 / 6.0) * std)[..., None] * generator.standard_normal(drawn_.shape)
        x_min, y_min, x_max, y_max = self.area
        drawn_ = np.clip(drawn_, [[x_min], [y_min]], [[x_max], [y_max]])
        if self._floor is not None:
            drawn_ = _rather_inside(drawn_, self._floor)
        after = candidates.copy()
        np.copyto(after[..., X : Y + 1, :m], drawn_, where=thin[..., None, None])
        return after


def _rather_inside(places: Floats, floor: Region) -> Floats:
    """Places (..., 2, n) of which those outside are moved onto others of their run that are inside, if any are."""
    good = floor.contains(np.swapaxes(places, -1, -2))
    order = np.argsort(~good, axis=-1, kind='stable')  # those inside come first
    count = np.maximum(good.sum(axis=-1, keepdims=True), 1)
    chosen = np.take_along_axis(order, np.arange(places.shape[-1]) % count, axis=-1)
    chosen = np.where(good.any(axis=-1, keepdims=True), chosen, np.arange(places.shape[-1]))
    return np.take_along_axis(places, chosen[..., None, :], axis=-1)
