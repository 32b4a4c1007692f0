"""What an estimator has heard lately, and where that alone says that the target is."""

from __future__ import annotations

from collections import deque

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.start import Area, Sight, likelihood_start, log_likelihood
from wsn_tracking.models.anchors import Floats
from wsn_tracking.trackers.readings import Readings


class Lookback:
    """The epochs of the last seconds in which something was heard."""

    def __init__(self, area: Area, speed: float) -> None:
        self._area, self._speed = area, speed
        self._heard: deque[tuple[int, Sight, Floats]] = deque()
        self._asked_ns: int | None = None

    def __len__(self) -> int:
        return len(self._heard)

    def clear(self) -> None:
        """Forget all."""
        self._heard.clear()
        self._asked_ns = None

    def add(self, stamp_ns: int, readings: Readings, m: Floats) -> None:
        """An epoch, and the state (n,) that the track had in it."""
        if readings.ids:
            self._heard.append((stamp_ns, Sight(0.0, readings.z, readings.h, readings.noise), m))

    def keep(self, stamp_ns: int, window: float) -> None:
        """Forget what is older than `window` [s]."""
        while self._heard and (stamp_ns - self._heard[0][0]) * 1e-9 > window:
            self._heard.popleft()

    def place(self, stamp_ns: int) -> Belief:
        """Where the target is by these epochs alone."""
        aged = [sight._replace(age=(stamp_ns - then) * 1e-9) for then, sight, _ in self._heard]
        return likelihood_start(aged, self._area, self._speed)

    def contradicts(self, stamp_ns: int, window: float, odds: float) -> bool:
        """Whether the epochs speak for another place than the track's, with log odds above `odds`; asked once a window.

        Shadows stay for seconds, so that a window tells no more than one epoch does: its mean counts. Where the epochs
        leave several places, the middle of these suits none, and the track goes on.
        """
        self._asked_ns = stamp_ns if self._asked_ns is None else self._asked_ns
        if not self._heard or (stamp_ns - self._asked_ns) * 1e-9 < window:
            return False
        self._asked_ns = stamp_ns
        best = self.place(stamp_ns).m
        gains = [log_likelihood(s, best[None]) - log_likelihood(s, m[None]) for _, s, m in self._heard]
        return float(np.mean(gains)) > odds
