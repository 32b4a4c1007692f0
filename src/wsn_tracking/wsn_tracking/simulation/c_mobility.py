"""How people walk in seed 003, section 4.1: straight legs to places of their choice, with a pause at each.

Functions take any leading axes (runs) and are drawn leg by leg, so that a longer walk begins like a shorter one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Floats
from wsn_tracking.simulation.paths import Area


class Mobility(NamedTuple):
    """Where a walker goes, how fast, and how long he stays."""

    area: Area  # [m]
    slowest: float = 0.5  # [m/s] a speed for each leg between this ...
    fastest: float = 2.0  # ... and this
    longest_pause: float = 10.0  # [s] at the end of a leg, between 0 and this
    turn_after: float = math.inf  # [s] mean time until he changes his mind on the way
    hot_spots: tuple[tuple[float, float], ...] = ()  # [m] places where people go
    hot_share: float = 0.0  # of the legs that lead to one of them


class Walked(NamedTuple):
    """A walk at given times."""

    states: Floats  # (runs, K, 4)
    heading: Floats  # (runs, K) [rad] of the leg, kept while he pauses


def destinations(mobility: Mobility, runs: int, generator: np.random.Generator) -> Floats:
    """Where each run goes next, (runs, 2) [m]."""
    low, high = np.array(mobility.area[:2]), np.array(mobility.area[2:])
    anywhere: Floats = low + (high - low) * generator.random((runs, 2))
    hot, which = generator.random(runs), generator.random(runs)
    if not mobility.hot_spots:
        return anywhere
    spots = np.array(mobility.hot_spots)
    chosen = spots[np.minimum((which * len(spots)).astype(np.int64), len(spots) - 1)]
    return np.where((hot < mobility.hot_share)[:, None], chosen, anywhere)


def legs(mobility: Mobility, start: Floats, times: ArrayLike, generator: np.random.Generator) -> Walked:
    """Walks from start (runs, 2) [m], at times (K,) [s] from 0 on."""
    t = np.asarray(times, dtype=np.float64)
    runs = len(start)
    states, heading = np.zeros((runs, t.size, 4)), np.zeros((runs, t.size))
    here, begin = start, np.zeros(runs)
    while begin.min() <= t[-1]:
        there = destinations(mobility, runs, generator)
        speed = mobility.slowest + (mobility.fastest - mobility.slowest) * generator.random(runs)
        pause = mobility.longest_pause * generator.random(runs)
        patience = mobility.turn_after * generator.standard_exponential(runs)
        way = np.hypot(*(there - here).T)
        arrives = np.minimum(way / speed, patience)
        pause = np.where(arrives < patience, pause, 0.0)
        angle = np.arctan2(there[:, 1] - here[:, 1], there[:, 0] - here[:, 0])
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        since = t - begin[:, None]
        on = (since >= 0.0) & (since < (arrives + pause)[:, None])
        walked = np.minimum(since, arrives[:, None]) * speed[:, None]
        v = np.where(since < arrives[:, None], speed[:, None], 0.0)
        at = np.concatenate([here[:, None] + walked[..., None] * u[:, None], v[..., None] * u[:, None]], axis=-1)
        states[on], heading[on] = at[on], np.broadcast_to(angle[:, None], on.shape)[on]
        here, begin = here + (arrives * speed)[:, None] * u, begin + arrives + pause
    return Walked(states, heading)


def teleported(
    mobility: Mobility, walked: Walked, times: ArrayLike, at: float, generator: np.random.Generator
) -> Walked:
    """The walks up to a time [s], from which on they go on half the area away in both directions."""
    t = np.asarray(times, dtype=np.float64)
    k = int(np.searchsorted(t, at))
    if k >= t.size:
        return walked
    low, high = np.array(mobility.area[:2]), np.array(mobility.area[2:])
    away = low + np.mod(walked.states[:, max(k - 1, 0), :2] - low + 0.5 * (high - low), high - low)
    rest = legs(mobility, away, t[k:] - t[k], generator)
    return Walked(*(np.concatenate([old[:, :k], new], axis=1) for old, new in zip(walked, rest, strict=True)))


def turned_body(times: ArrayLike, std: float, time: float, runs: int, generator: np.random.Generator) -> Floats:
    """How far bodies (runs, K) [rad] are turned away from where they walk: a stationary Gauss-Markov process."""
    t = np.asarray(times, dtype=np.float64)
    normals = generator.standard_normal((runs, t.size))
    yaw = np.empty((runs, t.size))
    yaw[:, 0] = std * normals[:, 0]
    for k in range(1, t.size):
        a = math.exp(-(t[k] - t[k - 1]) / time)
        yaw[:, k] = a * yaw[:, k - 1] + std * math.sqrt(1.0 - a * a) * normals[:, k]
    return yaw
