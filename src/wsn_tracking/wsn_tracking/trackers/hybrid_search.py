"""Where is the target? Least squares, or several hypotheses where least squares is not possible (system D)."""

from __future__ import annotations

import math

import numpy as np

from wsn_tracking.filters import hypotheses
from wsn_tracking.filters.agreement import Told, agreed
from wsn_tracking.filters.ekf import Gaussian
from wsn_tracking.filters.hypotheses import Box, Hypotheses
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import forgetful_velocity
from wsn_tracking.trackers.hybrid_config import HybridConfig
from wsn_tracking.trackers.hybrid_readings import Distance

PLENTY = 5  # ranges that must agree; where a whole window brought fewer, three do
ELSEWHERE = 0.1  # probability that a target that was lost is not where it would have gone


class Search:
    """One search for one target, range by range; `belief_at` says what is known so far, flat over the area at first.

    `last`: where a track was lost, and when [s].
    """

    def __init__(
        self, config: HybridConfig, places: Floats, area: Box, last: Gaussian | None = None, t: float = math.nan
    ) -> None:
        self._config, self._places, self._area = config, places, area
        self._told: list[tuple[Distance, float]] = []  # in the window of least squares, and when
        self._last = None if last is None else hypotheses.one(last)
        self._left: Hypotheses | None = None  # no range yet: None
        self._t = t
        self._begun = math.inf

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
        start = self._config.start
        self._begun = min(self._begun, t)
        self._told = [(d, then) for d, then in (*self._told, (distance, t)) if t - then <= start.window]
        if start.kind != 'hypotheses':
            found = self._least_squares(t)
            if found is not None:
                return found
        if start.kind == 'ls':
            return None
        self._follow(distance, t)
        if start.kind == 'auto' and (t - self._begun < start.window or len({d.row for d, _ in self._told}) >= 3):
            return None  # least squares may still find it
        belief = self.belief_at(t)
        extent = math.sqrt(float(np.linalg.eigvalsh(belief.P[:2, :2])[-1]))
        return belief if extent <= start.resolved else None

    def _least_squares(self, t: float) -> Gaussian | None:
        start = self._config.start
        a = np.array([self._places[d.row, :2] for d, _ in self._told])
        std = np.array([math.hypot(d.std, d.share * d.z) for d, _ in self._told])
        age = np.array([t - then for _, then in self._told])
        plane = np.array([_in_plane(d.z, self._places[d.row, 2]) for d, _ in self._told])
        least = PLENTY if t - self._begun < start.window else 3
        x = agreed(Told(a, plane, start.misfit * std + start.velocity_std * age), least, start.majority)
        if x is None or not _inside(x, self._area, start.position_std):
            return None
        return Gaussian(np.concatenate([x, np.zeros(2)]), start.P0)

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
        d = _in_plane(distance.z, float(place[2]))
        std = math.hypot(distance.std, distance.share * distance.z) * distance.z / max(d, distance.std, 1e-3)
        return hypotheses.ring(place[:2], d, std, self._area, start.velocity_std, start.most)

    def _moved(self, places: Hypotheses, t: float) -> Hypotheses:
        if not t > self._t:
            return places
        motion = self._config.motion
        F, chol_Q = forgetful_velocity(motion.spectral_density, t - self._t, motion.velocity_time)
        return hypotheses.predict(places, F, chol_Q @ chol_Q.T)


def _in_plane(z: float, height: float) -> float:
    """The distance in the plane that a range tells; zero where it is shorter than the height."""
    return math.sqrt(max(z * z - height * height, 0.0))


def _inside(x: Floats, box: Box, margin: float) -> bool:
    return bool(box[0] - margin <= x[0] <= box[2] + margin and box[1] - margin <= x[1] <= box[3] + margin)


def _flat(area: Box, velocity_std: float) -> Gaussian:
    """Mean and covariance of a uniform density over an area, at rest on the average."""
    low, high = np.array(area[:2]), np.array(area[2:])
    variance = np.square(high - low) / 12.0
    return Gaussian(np.concatenate([0.5 * (low + high), np.zeros(2)]), np.diag([*variance, *[velocity_std**2] * 2]))
