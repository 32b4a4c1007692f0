"""Motion models; the state order is [x, y, vx, vy] throughout the project."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats


def constant_velocity(dt: ArrayLike) -> Floats:
    """Transition matrix of the constant-velocity model (seed 000, eq. 3), shape (..., 4, 4).

    dt (...) [s]. The document interleaves positions and velocities; here positions come first.
    """
    dt = np.asarray(dt, dtype=np.float64)
    F = np.empty((*dt.shape, 4, 4))
    F[...] = np.eye(4)
    F[..., 0, 2] = F[..., 1, 3] = dt
    return F
