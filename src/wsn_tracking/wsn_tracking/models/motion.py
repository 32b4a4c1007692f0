"""Motion models; the state order is [x, y, vx, vy] throughout the project, where a target turns with w behind it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.noise import white_acceleration

SHORT = 1e-3  # below this share of the time a difference of exponentials loses its digits: its series is used

TURNING_STATES = ('x', 'y', 'vx', 'vy', 'w')
SMALL = 1e-2  # angle below which slopes come from their series: both forms are good to 1e-12 there


def constant_velocity(dt: ArrayLike) -> Floats:
    """Transition matrix of the constant-velocity model (seed 000, eq. 3), shape (..., 4, 4).

    dt (...) [s]. The document interleaves positions and velocities; here positions come first.
    """
    dt = np.asarray(dt, dtype=np.float64)
    F = np.empty((*dt.shape, 4, 4))
    F[...] = np.eye(4)
    F[..., 0, 2] = F[..., 1, 3] = dt
    return F


class Turn(NamedTuple):
    """What a turn of a = w T does to a velocity, each (...)."""

    cos: Floats
    sin: Floats
    s: Floats  # [s] along the velocity
    c: Floats  # [s] across it, to the left


def turn(w: ArrayLike, dt: ArrayLike) -> Turn:
    """A turn at w (...) [rad/s] for dt (...) [s]."""
    T = np.asarray(dt, dtype=np.float64)
    a = np.asarray(w, dtype=np.float64) * T
    half = 0.5 * a
    return Turn(np.cos(a), np.sin(a), T * np.sinc(a / np.pi), T * np.sin(half) * np.sinc(half / np.pi))


def coordinated_turn(x: Floats, dt: ArrayLike) -> Floats:
    """States (..., 5) after dt (...) [s] of a turn at constant w (seed 004, whose text breaks off before the equation).

    x' = x + s vx - c vy    vx' = vx cos wT - vy sin wT    s = sin(wT) / w
    y' = y + c vx + s vy    vy' = vx sin wT + vy cos wT    c = (1 - cos(wT)) / w

    s and c are written with sin(a) / a, so that w = 0 (s = T, c = 0) is no special case and nothing cancels near it.
    """
    t = turn(x[..., 4], dt)
    vx, vy = x[..., 2], x[..., 3]
    moved = (
        x[..., 0] + t.s * vx - t.c * vy,
        x[..., 1] + t.c * vx + t.s * vy,
        t.cos * vx - t.sin * vy,
        t.sin * vx + t.cos * vy,
        x[..., 4],
    )
    return np.stack(np.broadcast_arrays(*moved), axis=-1)


def turn_jacobian(x: Floats, dt: ArrayLike) -> Floats:
    """The derivative of `coordinated_turn` at states (..., 5), (..., 5, 5)."""
    T = np.asarray(dt, dtype=np.float64)
    t = turn(x[..., 4], T)
    vx, vy = x[..., 2], x[..., 3]
    ds, dc = _slopes(x[..., 4] * T, T)
    F = np.zeros((*t.cos.shape, 5, 5))
    F[..., range(5), range(5)] = 1.0
    F[..., 0, 2] = F[..., 1, 3] = t.s
    F[..., 0, 3], F[..., 1, 2] = -t.c, t.c
    F[..., 2, 2] = F[..., 3, 3] = t.cos
    F[..., 2, 3], F[..., 3, 2] = -t.sin, t.sin
    F[..., 0, 4] = ds * vx - dc * vy
    F[..., 1, 4] = dc * vx + ds * vy
    F[..., 2, 4] = -T * (t.sin * vx + t.cos * vy)
    F[..., 3, 4] = T * (t.cos * vx - t.sin * vy)
    return F


def _slopes(a: Floats, T: Floats) -> tuple[Floats, Floats]:
    """ds/dw and dc/dw [s^2] of a turn by a = w T."""
    small = np.abs(a) < SMALL
    b = np.where(small, 1.0, a)
    ds = np.where(small, a * (a * a / 30.0 - 1.0 / 3.0), (np.cos(b) - np.sin(b) / b) / b)
    dc = np.where(small, 0.5 - a * a * (1.0 / 8.0 - a * a / 144.0), (np.sin(b) - (1.0 - np.cos(b)) / b) / b)
    return T * T * ds, T * T * dc


def forgetful_velocity(spectral_density: ArrayLike, dt: float, time: float = 0.0) -> tuple[Floats, Floats]:
    """Transition F (4, 4) and noise root chol_Q (..., 4, 4) of a velocity that fades, with `time` [s], and is renewed.

    dv = -v / time dt + dw, w of spectral density S (...) [m^2/s^3]: an Ornstein-Uhlenbeck velocity of variance
    S time / 2, whose position does not run away over long gaps. time = 0: it never fades, which is white acceleration.
    dt >= 0 [s].
    """
    S = np.asarray(spectral_density, dtype=np.float64)
    if not time or not dt:
        return constant_velocity(dt), white_acceleration(S, dt)
    u = dt / time
    a, b = np.exp(-u), -np.expm1(-u)  # what is left of a velocity, and of its way in units of time
    F = np.diag([1.0, 1.0, a, a])
    F[0, 2] = F[1, 3] = time * b
    vv, pv = -0.5 * np.expm1(-2.0 * u), 0.5 * b * b
    pp = u - 2.0 * b + vv if u > SHORT else u**3 / 3.0 - u**4 / 4.0
    p = np.sqrt(pp)
    growing, along, steady = time * p, pv / p, np.sqrt(max(vv - pv * pv / pp, 0.0))
    root = np.diag([growing] * 2 + [steady] * 2) + np.diag([along] * 2, -2)
    return F, np.sqrt(S * time)[..., None, None] * root
