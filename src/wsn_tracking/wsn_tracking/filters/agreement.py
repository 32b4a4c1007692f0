"""Least squares of those ranges that agree, where some may be of another target (random sample consensus, in full)."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters.least_squares import least_squares
from wsn_tracking.models.anchors import Floats

MOST = 14  # ranges that are looked at: all 364 threes of them


class Told(NamedTuple):
    """Ranges in a window, the latest last."""

    a: Floats  # (M, 2) [m] where their nodes are
    d: Floats  # (M,) [m] distances in the plane
    tolerance: Floats  # (M,) [m] by which each may be off


def agreed(told: Told, least: int, majority: float) -> Floats | None:
    """Position (2,) [m] by least squares of the largest set of ranges that agree with a position; None: there is none.

    At least so many ranges (three; they nearly always agree) and this share of all must do, of nodes not on a line.
    """
    told = Told(*(column[-MOST:] for column in told))
    if len(told.d) < max(least, 3):
        return None
    threes = np.array(list(combinations(range(len(told.d)), 3)))
    x = least_squares(told.a[threes], told.d[threes])
    agreeing = _agreeing(told, x)
    best = agreeing[np.argmax(agreeing.sum(axis=-1))]
    found = least_squares(told.a, np.where(best, told.d, np.nan))
    kept = _agreeing(told, found)
    if np.isnan(found[0]) or kept.sum() < max(least, majority * len(told.d)):
        return None
    return found


def _agreeing(told: Told, x: Floats) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Which ranges (..., M) agree with positions x (..., 2)."""
    off = np.sqrt(np.sum(np.square(x[..., None, :] - told.a), axis=-1)) - told.d
    with np.errstate(invalid='ignore'):
        return np.asarray(np.abs(off) <= told.tolerance)
