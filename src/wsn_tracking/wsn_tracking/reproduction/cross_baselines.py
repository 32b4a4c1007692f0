"""What nobody should need a filter to beat: places told by one epoch alone."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from wsn_tracking.filters.least_squares import least_squares
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.hybrid_readings import DistanceTable


class Memoryless(ABC):
    """Places a target by the distances of the latest epoch that was enough; covariance and velocity are not known."""

    def __init__(self, anchors: Anchors, target_height: float = 0.0) -> None:
        self._table = DistanceTable(anchors, 0.0)
        self._nodes = anchors.positions[:, :2]
        self._above = anchors.positions[:, 2] - target_height
        self.reset()

    @property
    def outputs(self) -> tuple[str, ...]:
        """One."""
        return (type(self).__name__.lower(),)

    def reset(self) -> None:
        """Forget the last place: until another one is known, the target is in the middle of the nodes."""
        self.counters: Counter[str] = Counter()
        self._last: Floats = self._nodes.mean(axis=0)

    def state(self) -> Mapping[str, Any]:
        """Nothing."""
        return {}

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """Where it is by this epoch, or where it was."""
        z = np.full(len(self._nodes), np.nan)
        for distance in self._table.read(epoch, self.counters):
            z[distance.row] = distance.z
        found = self.place(np.sqrt(np.maximum(z**2 - self._above**2, 0.0)))
        if np.all(np.isfinite(found)):
            self._last = found
        mean = np.concatenate([self._last, np.zeros(2)])
        head = epoch.stamp_ns, epoch.target_id, epoch.request_seq
        return (Estimate(*head, self.outputs[0], mean, np.full((4, 4), np.nan)),)

    @abstractmethod
    def place(self, d: Floats) -> Floats:
        """The place (2,) of plane distances (N,) [m], NaN where nothing was heard; NaN where they are not enough."""


class Nearest(Memoryless):
    """At the node that is nearest by what it hears."""

    def place(self, d: Floats) -> Floats:
        """Where that node is."""
        return self._nodes[np.nanargmin(d)] if np.any(~np.isnan(d)) else np.full(2, np.nan)


class Fix(Memoryless):
    """Least squares of one epoch."""

    def place(self, d: Floats) -> Floats:
        """Where the circles meet."""
        return least_squares(self._nodes, d)
