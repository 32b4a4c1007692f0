"""Where a simulated target walks: positions and velocities at given times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats


def polygon_loop(corners: Sequence[tuple[float, float]], speed: float, times: ArrayLike) -> Floats:
    """States (K, 4) of a walk at constant speed [m/s] round a closed polygon, from its first corner, at times (K,) [s].

    At a corner the velocity is that of the side to come.
    """
    start = np.asarray(corners, dtype=np.float64)
    side = np.roll(start, -1, axis=0) - start
    length = np.hypot(side[:, 0], side[:, 1])
    ends = np.cumsum(length)
    walked = np.mod(speed * np.asarray(times, dtype=np.float64), ends[-1])
    i = np.minimum(np.searchsorted(ends, walked, side='right'), ends.size - 1)
    along = (walked - ends[i] + length[i]) / length[i]
    return np.column_stack([start[i] + along[:, None] * side[i], speed * side[i] / length[i, None]])
