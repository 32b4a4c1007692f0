"""Where today's particles were some seconds ago: fixed-lag smoothing by ancestral paths (Kitagawa 1996)."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from wsn_tracking.filters.particle import descended, taken
from wsn_tracking.filters.resampling import Indices
from wsn_tracking.models.anchors import Floats


class Generation(NamedTuple):
    """The particles of one epoch."""

    time: float  # [s]
    values: Floats  # (..., K, P)
    parents: Indices | None  # (..., P) of each particle in the generation before; None: it is its own successor


class Ancestry:
    """The generations of the last `span` seconds, and one before."""

    def __init__(self, span: float) -> None:
        self.span = span
        self._generations: deque[Generation] = deque()

    def clear(self) -> None:
        """Forget all: a track that begins anew has no ancestors."""
        self._generations.clear()

    def add(self, time: float, values: Floats, parents: Indices | None) -> None:
        """The particles of a new epoch, whose parents are particles of the one before."""
        self._generations.append(Generation(time, values, parents))
        while len(self._generations) > 1 and self._generations[1].time <= time - self.span:
            self._generations.popleft()

    def before(self, time: float) -> bool:
        """Whether the paths reach back to that time."""
        return bool(self._generations) and self._generations[0].time <= time

    def at(self, time: float) -> Floats:
        """Values (..., K, P) of the newest particles' ancestors at a time [s].

        Linear between epochs; the oldest that are known where that is before them.
        """
        path: Indices | None = None
        later = self._generations[-1]
        places = later.values
        for earlier in reversed([*self._generations][:-1]):
            if later.time <= time:
                break
            path = descended(later.parents, path)
            came_from = earlier.values if path is None else taken(earlier.values, path)
            if earlier.time <= time:
                share = (time - earlier.time) / (later.time - earlier.time)
                return came_from + share * (places - came_from)
            later, places = earlier, came_from
        return places
