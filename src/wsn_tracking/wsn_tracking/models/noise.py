"""Process noise as a square root: chol_Q with Q = chol_Q chol_Q', states [x, y, vx, vy], and w [rad/s] of a turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats

CM = 0.01  # [m]
CM_EYE = CM * np.eye(4)
# [[T / sqrt(3), 0], [sqrt(3) / 2, 1 / 2]] per axis, the root of white acceleration over sqrt(S T): T GROWING + STEADY
GROWING = np.diag([1.0, 1.0, 0.0, 0.0]) / np.sqrt(3.0)
STEADY = np.diag([0.5 * np.sqrt(3.0)] * 2, -2) + np.diag([0.0, 0.0, 0.5, 0.5])


def scaled_identity(q: ArrayLike) -> Floats:
    """S_Q = q I (seed 000, section 3.1), shape (..., 4, 4) in SI units.

    q (...) counts cm for positions and cm/s for velocities and means one step of T = 1 s: the document
    gives no other, and the model has no rule to scale it with.
    """
    return np.asarray(q, dtype=np.float64)[..., None, None] * CM_EYE


def white_acceleration(spectral_density: ArrayLike, dt: ArrayLike) -> Floats:
    """Root of continuous white-noise acceleration, shape (..., 4, 4).

    Q = S [[T^3/3, T^2/2], [T^2/2, T]] per axis; spectral_density S (...) [m^2/s^3], dt T (...) [s], T >= 0.
    """
    S, T = np.asarray(spectral_density, dtype=np.float64), np.asarray(dt, dtype=np.float64)
    return np.asarray(np.sqrt(S * T)[..., None, None] * (T[..., None, None] * GROWING + STEADY))


def turn_noise(acceleration_std: ArrayLike, turn_std: ArrayLike, dt: ArrayLike) -> Floats:
    """A root of Q = blkdiag(sv^2 (G x I2), sw^2 T), G = [[T^4/4, T^3/2], [T^3/2, T^2]], shape (..., 5, 5).

    sv [m/s^2] is an acceleration that lasts the step; the turn rate is a random walk of sw [rad/s] in a second, which
    is the sw of the document at its T = 1 s. The root is as singular as Q is: two columns are zero.
    """
    sv, sw, T = (np.asarray(v, dtype=np.float64) for v in (acceleration_std, turn_std, dt))
    root = np.zeros((*np.broadcast_shapes(sv.shape, sw.shape, T.shape), 5, 5))
    root[..., 0, 0] = root[..., 1, 1] = 0.5 * sv * T * T
    root[..., 2, 0] = root[..., 3, 1] = sv * T
    root[..., 4, 4] = sw * np.sqrt(T)
    return root
