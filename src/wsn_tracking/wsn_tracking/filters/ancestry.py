"""Where today's particles were some seconds ago: fixed-lag smoothing by ancestral paths (Kitagawa 1996).

Paths die out with every resampling, until all of today's particles descend from a few of then, or from one. What few
draws say of a mean is known to their own number only: `moments` owns up to it.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters import particle
from wsn_tracking.filters.particle import descended, taken, worth
from wsn_tracking.filters.resampling import Indices
from wsn_tracking.models.anchors import Floats


class Generation(NamedTuple):
    """The particles of one epoch."""

    time: float  # [s]
    values: Floats  # (..., K, P)
    covariance: Floats  # (..., K, K) of these values, as the filter told it then
    parents: Indices | None  # (..., P) of each particle in the generation before; None: it is its own successor


class Past(NamedTuple):
    """Today's particles as they were."""

    values: Floats  # (..., K, P)
    covariance: Floats  # (..., K, K) what the filter told then
    ancestors: Indices | None  # (..., P) which of its particles then they descend from; None: each from its own


class Ancestry:
    """The generations of the last `span` seconds, and one before."""

    def __init__(self, span: float) -> None:
        self.span = span
        self._generations: deque[Generation] = deque()

    def clear(self) -> None:
        """Forget all: a track that begins anew has no ancestors."""
        self._generations.clear()

    def add(self, time: float, values: Floats, covariance: Floats, parents: Indices | None) -> None:
        """The particles of a new epoch, what the filter tells of them, and their parents in the epoch before."""
        self._generations.append(Generation(time, values, covariance, parents))
        while len(self._generations) > 1 and self._generations[1].time <= time - self.span:
            self._generations.popleft()

    def before(self, time: float) -> bool:
        """Whether the paths reach back to that time."""
        return bool(self._generations) and self._generations[0].time <= time

    def moments(self, time: float, w: Floats, floor: float = 0.0) -> tuple[Floats, Floats]:
        """Mean (..., K) and covariance (..., K, K) at a time [s], by what was heard since; w (..., P): today's weights.

        The mean of n equal ancestors, draws from what was believed then, is off by the n-th part of its covariance. So
        much is added to what the paths scatter: where one ancestor is left nothing is known beyond what was known then.
        floor: as in `particle.moments`.
        """
        past = self.at(time)
        mean, P = particle.moments(past.values, w, floor)
        return mean, P + past.covariance / _worth_of_ancestors(w, past.ancestors)[..., None, None]

    def at(self, time: float) -> Past:
        """The newest particles' ancestors at a time [s].

        Values are linear between epochs; the oldest that are known where that is before them.
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
                return Past(came_from + share * (places - came_from), earlier.covariance, path)
            later, places = earlier, came_from
        return Past(places, later.covariance, path)


def _worth_of_ancestors(w: Floats, ancestors: Indices | None) -> Floats:
    """How many equal ancestors the weights (..., P) of today are worth, (...)."""
    if ancestors is None:
        return worth(w)
    size = int(ancestors.max()) + 1
    row = np.arange(w.size // w.shape[-1]).reshape((*w.shape[:-1], 1)) * size
    families = np.bincount((row + ancestors).ravel(), w.ravel(), minlength=(w.size // w.shape[-1]) * size)
    return worth(families.reshape((*w.shape[:-1], size)))
