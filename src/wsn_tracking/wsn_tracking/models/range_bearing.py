"""Range and bearing of a target, each node looking from its own place at its own belief.

Unlike in `measurement`, where all nodes look at one state, a node is an element of the batch here: nodes at positions
(..., 3) [m] map states (..., K, n) to (..., K, 2), range [m] and bearing [rad] from the x axis, counter-clockwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function
from wsn_tracking.models.radio import MIN_RANGE

TWO_PI = 2.0 * np.pi


def wrapped(angle: ArrayLike) -> Floats:
    """The angle (...) [rad] in (-pi, pi]."""
    return np.asarray(np.pi - np.mod(np.pi - np.asarray(angle, dtype=np.float64), TWO_PI))


def range_bearing_function(positions: Floats, about: Floats, height: float = 0.0) -> Function:
    """h(x) = [|x - a|, atan2(y - a_y, x - a_x)] (seed 002, section 3), with no jump at +-pi.

    The bearing is counted within half a turn of the bearing at `about` (..., n), so that the points of a cubature rule
    round it average to an angle between them. A target at another height than its node has a three-dimensional range.
    """
    place = positions[..., None, :]
    dz_squared = np.square(height - place[..., 2])
    offset = about[..., :2] - positions[..., :2]
    centre = np.arctan2(offset[..., 1], offset[..., 0])[..., None]

    def h(states: Floats) -> Floats:
        dx, dy = states[..., 0] - place[..., 0], states[..., 1] - place[..., 1]
        z = np.empty((*dx.shape, 2))
        z[..., 0] = np.maximum(np.sqrt(dx * dx + dy * dy + dz_squared), MIN_RANGE)
        z[..., 1] = centre + wrapped(np.arctan2(dy, dx) - centre)
        return z

    return h


def innovation(z: Floats, z_hat: Floats) -> Floats:
    """v = z - z_hat (..., 2) with the bearing's in (-pi, pi]; NaN where z is."""
    v = z - z_hat
    v[..., 1] = wrapped(v[..., 1])
    return v
