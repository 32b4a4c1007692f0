"""Where a simulated target walks: positions and velocities at given times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats

Area = tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]


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


def circle(centre: tuple[float, float], radius: float, speed: float, times: ArrayLike) -> Floats:
    """States (K, 4) at constant speed [m/s] round a circle [m], counter-clockwise from its easternmost point."""
    angle = speed / radius * np.asarray(times, dtype=np.float64)
    return round_circle(centre, radius, angle, np.full(angle.shape, speed / radius))


def headings_inside(area: Area, headings: ArrayLike, speed: float, leg: float, times: ArrayLike) -> Floats:
    """States (..., K, 4) of walks from the middle of an area, a heading (..., L) [rad] for every `leg` [s].

    Constant speed [m/s]; times (K,) [s] at most L legs. At its border a walk is reflected, and goes on as reflected
    until its next heading.
    """
    low, high = np.array(area[:2]), np.array(area[2:])
    angle, t = np.asarray(headings, dtype=np.float64), np.asarray(times, dtype=np.float64)
    velocity = speed * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    leg_of = np.minimum((t // leg).astype(np.int64), angle.shape[-1] - 1)
    states = np.empty((*angle.shape[:-1], t.size, 4))
    begin = np.broadcast_to(0.5 * (low + high), velocity[..., 0, :].shape)
    for i in range(angle.shape[-1]):
        at = leg_of == i
        v = velocity[..., i, None, :]
        position, sign = _folded(begin[..., None, :] + v * (t[at] - i * leg)[:, None], low, high)
        states[..., at, :2], states[..., at, 2:] = position, v * sign
        begin, _ = _folded(begin + v[..., 0, :] * leg, low, high)
    return states


def _folded(x: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where a straight way to x (..., 2) has been reflected to, and the sign of each direction there."""
    width = high - low
    turned = np.mod(x - low, 2.0 * width)
    back = turned > width
    return low + np.where(back, 2.0 * width - turned, turned), np.where(back, -1.0, 1.0)


def line_and_stop(start: tuple[float, float], velocity: tuple[float, float], until: float, times: ArrayLike) -> Floats:
    """States (K, 4) of a straight walk that stops suddenly at `until` [s], at times (K,) [s]."""
    t = np.asarray(times, dtype=np.float64)[:, None]
    v = np.asarray(velocity, dtype=np.float64)
    return np.concatenate([np.asarray(start) + v * np.minimum(t, until), np.where(t < until, v, 0.0)], axis=-1)


def round_circle(centre: tuple[float, float], radius: float, angle: ArrayLike, turning: ArrayLike) -> Floats:
    """States (K, 4) on a circle [m] at angles (K,) [rad], counter-clockwise from the east, turning at (K,) [rad/s]."""
    angle, v = np.asarray(angle, dtype=np.float64), radius * np.asarray(turning, dtype=np.float64)
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([centre[0] + radius * c, centre[1] + radius * s, -v * s, v * c])
