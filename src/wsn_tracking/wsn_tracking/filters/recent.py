"""Least squares of the latest range of each node, low-passed (seed 001, section 2): where a target is by now."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.filters.least_squares import least_squares
from wsn_tracking.models.anchors import Floats

KEEP_V = 0.7  # share of the past in the low-passed velocity


class Recent(NamedTuple):
    """What each node said last, and what least squares made of it."""

    d: Floats  # (..., N) [m] distances in the plane; NaN: never heard
    t: Floats  # (..., N) [s] when
    weights: Floats  # (..., N) inverse variance of d^2
    raw: Floats  # (..., 2) [m] least squares now; NaN where there is none
    x: Floats  # (..., 4) [m, m/s] low-passed position and velocity; NaN where there was none yet
    since: Floats  # (...) [s] from when on there has been one without a break; NaN: there is none
    at: Floats  # (...) [s] when x was made


def nothing(shape: tuple[int, ...], nodes: int) -> Recent:
    """Before anything was heard; shape of the batch."""
    never, unknown = np.full((*shape, nodes), np.nan), np.full(shape, np.nan)
    nowhere = np.full((*shape, 4), np.nan)
    return Recent(never, np.full_like(never, -np.inf), never, nowhere[..., :2], nowhere, unknown, unknown)


def hear(recent: Recent, rows: NDArray[np.int64], d: Floats, weights: Floats, t: ArrayLike) -> Recent:
    """Distances d (...) of nodes in rows (...) at t (...) [s]; NaN: nothing was heard."""
    is_it = (np.arange(recent.d.shape[-1]) == rows[..., None]) & ~np.isnan(d)[..., None]
    now = np.asarray(t, dtype=np.float64)[..., None]
    return recent._replace(
        d=np.where(is_it, d[..., None], recent.d),
        t=np.where(is_it, now, recent.t),
        weights=np.where(is_it, weights[..., None], recent.weights),
    )


def solve(recent: Recent, positions: Floats, t: ArrayLike, age_max: float, weighted: bool = False) -> Floats:
    """Least squares (..., 2) of the distances no older than age_max [s] at t; NaN where these do not suffice."""
    now = np.asarray(t, dtype=np.float64)
    young = now[..., None] - recent.t <= age_max * (1.0 + 1e-9)
    return least_squares(positions, np.where(young, recent.d, np.nan), recent.weights if weighted else None)


def misfit(recent: Recent, positions: Floats, x: Floats, t: ArrayLike, age_max: float, speed: float) -> Floats:
    """How far, at most, a young distance is from what x (..., 2) says (...) [m], beyond what `speed` may have changed.

    x NaN: NaN.
    """
    age = np.asarray(t, dtype=np.float64)[..., None] - recent.t
    d = np.sqrt(np.sum(np.square(x[..., None, :] - positions), axis=-1))
    off = np.maximum(np.abs(recent.d - d) - speed * np.minimum(age, age_max), 0.0)
    young = (age <= age_max * (1.0 + 1e-9)) & ~np.isnan(recent.d)
    worst = np.max(np.where(young, off, 0.0), axis=-1)
    return np.asarray(np.where(np.isnan(x[..., 0]), np.nan, worst))


def follow(recent: Recent, raw: Floats, t: ArrayLike, age_max: float, weight: float = 0.5) -> Recent:
    """Low-pass least squares raw (..., 2): xz = a raw + (1 - a) xz, vz = 0.7 vz + 0.3 dxz / dt (seed 001, eq. 12).

    Where there has been none (NaN) for age_max [s] the low pass begins anew.
    """
    now = np.asarray(t, dtype=np.float64)
    valid = ~np.isnan(raw[..., 0])
    with np.errstate(invalid='ignore'):
        anew = ~(now - recent.at <= age_max * (1.0 + 1e-9))
    held = np.where(anew[..., None], np.concatenate([raw, np.zeros_like(raw)], axis=-1), recent.x)
    xz = weight * raw + (1.0 - weight) * held[..., :2]
    dt = np.where(anew | (now <= recent.at), np.inf, now - recent.at)
    vz = KEEP_V * held[..., 2:] + (1.0 - KEEP_V) * (xz - held[..., :2]) / dt[..., None]
    x = np.where(valid[..., None], np.concatenate([xz, vz], axis=-1), recent.x)
    since = np.where(valid, np.where(np.isnan(recent.since) | anew, now, recent.since), np.nan)
    return recent._replace(raw=raw, x=x, since=since, at=np.where(valid, now, recent.at))
