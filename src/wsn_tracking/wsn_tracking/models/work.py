"""Work arrays that are kept from call to call, so that an inner loop allocates nothing."""

from __future__ import annotations

import math

import numpy as np

from wsn_tracking.models.anchors import Floats


class Work:
    """Arrays by name, of whatever shape is asked for; what they held is lost at the next call for the same name."""

    def __init__(self) -> None:
        self._held: dict[str, Floats] = {}

    def of(self, name: str, shape: tuple[int, ...]) -> Floats:
        """An array of that shape, not set to anything."""
        size = math.prod(shape)
        held = self._held.get(name)
        if held is None or held.size < size:
            held = self._held[name] = np.empty(size)
        return held[:size].reshape(shape)
