"""Where is the target? Least squares, or several hypotheses where least squares is not possible (system D)."""

from __future__ import annotations

import math

import numpy as np

from wsn_tracking.filters import hypotheses, recent
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.hypotheses import Hypotheses
from wsn_tracking.filters.start import Area
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import forgetful_velocity
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_readings import Distance

ELSEWHERE = 0.1  # probability that a target that was lost is not where it would have gone


class Search:
    """One search for one target, range by range; `belief_at` says what is known so far, flat over the area at first.

    `last`: where a track was lost, and when [s].
    """

    def __init__(
        self, config: HybridConfig, places: Floats, area: Area, last: Gaussian | None = None, t: float = math.nan
    ) -> None:
        self._config, self._places, self._area = config, places, area
        self._recent = recent.nothing((), len(places))
        self._last = None if last is None else hypotheses.one(last)
        self._left: Hypotheses | None = None  # no range yet: None
        self._t = t

    def belief_at(self, t: float) -> Gaussian:
        """Mean and covariance of where the target may be at t [s]."""
        places = self._last if self._left is None else self._left
        if places is None:
            return _flat(self._area, self._config.start.velocity_std)
        return hypotheses.moments(self._moved(places, t))

    @property
    def count(self) -> int:
        """How many hypotheses there are; 0 before the first range."""
        return 0 if self._left is None else len(self._left.w)

    def hear(self, distance: Distance, t: float) -> Gaussian | None:
        """Take one range in at t [s]; what a track can begin with, as soon as there is enough."""
        kind = self._config.start.kind
        if kind != 'hypotheses':
            found = self._least_squares(distance, t)
            if found is not None:
                return found
        if kind == 'ls':
            return None
        self._follow(distance, t)
        belief = self.belief_at(t)
        extent = math.sqrt(float(np.linalg.eigvalsh(belief.P[:2, :2])[-1]))
        return belief if extent <= self._config.start.resolved else None

    def _least_squares(self, distance: Distance, t: float) -> Gaussian | None:
        start, xy = self._config.start, self._places[:, :2]
        std = math.hypot(distance.std, distance.share * distance.z)
        d = math.sqrt(max(distance.z**2 - self._places[distance.row, 2] ** 2, 0.0))
        weight = np.asarray(1.0 / max((2.0 * d * std) ** 2, 1e-12))
        self._recent = recent.hear(self._recent, np.asarray(distance.row), np.asarray(d), weight, t)
        x = recent.solve(self._recent, xy, t, start.window, distance.share > 0.0)
        if math.isnan(x[0]) or not _inside(x, self._area):
            return None
        off = recent.misfit(self._recent, xy, x, t, start.window, start.velocity_std)
        if start.misfit and float(off) > start.misfit * std:
            return None
        P = np.diag(np.square([start.position_std, start.position_std, start.velocity_std, start.velocity_std]))
        return Gaussian(np.concatenate([x, np.zeros(2)]), P)

    def _follow(self, distance: Distance, t: float) -> None:
        """The hypotheses with one range more."""
        config, place = self._config, self._places[distance.row]
        told = distance.z, place, distance.std, distance.share, config.robust.dof
        if self._left is not None:
            places, _ = hypotheses.update(self._moved(self._left, t), *told)
        elif self._last is None:
            places = self._ring(distance)
        else:
            places, log_l = hypotheses.update(self._moved(self._last, t), *told)
            extent = math.hypot(self._area[2] - self._area[0], self._area[3] - self._area[1])
            here, there = (1.0 - ELSEWHERE) * math.exp(log_l), ELSEWHERE / extent
            places = hypotheses.together(places, self._ring(distance), there / (here + there))
        fade = math.hypot(distance.std, distance.share * distance.z)
        self._left = hypotheses.reduced(hypotheses.kept_inside(places, self._area, fade), config.start.most)
        self._t = t

    def _ring(self, distance: Distance) -> Hypotheses:
        place, start = self._places[distance.row], self._config.start
        d = math.sqrt(max(distance.z**2 - place[2] ** 2, 0.0))
        std = math.hypot(distance.std, distance.share * distance.z) * distance.z / max(d, distance.std, 1e-3)
        return hypotheses.ring(place[:2], d, std, self._area, start.velocity_std, start.most)

    def _moved(self, places: Hypotheses, t: float) -> Hypotheses:
        if not t > self._t:
            return places
        motion = self._config.motion
        F, chol_Q = forgetful_velocity(motion.spectral_density, t - self._t, motion.velocity_time)
        return hypotheses.predict(places, F, chol_Q @ chol_Q.T)


def _inside(x: Floats, area: Area) -> bool:
    return bool(area[0] <= x[0] <= area[2] and area[1] <= x[1] <= area[3])


def _flat(area: Area, velocity_std: float) -> Gaussian:
    """Mean and covariance of a uniform density over an area, at rest on the average."""
    low, high = np.array(area[:2]), np.array(area[2:])
    variance = np.square(high - low) / 12.0
    return Gaussian(np.concatenate([0.5 * (low + high), np.zeros(2)]), np.diag([*variance, *[velocity_std**2] * 2]))
