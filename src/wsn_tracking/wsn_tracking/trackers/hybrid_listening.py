"""What a target's ranges say by least squares, as they come (seed 001, section 2), over any leading axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.filters import recent
from wsn_tracking.filters.recent import Recent
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.trackers.hybrid_config import HybridConfig

Rows = NDArray[np.int64]


class Reading(NamedTuple):
    """One range an element of the batch, freed of its radio's scale and bias."""

    z: Floats  # (...) [m]; NaN: none
    rows: Rows  # (...) row of its node among places (N, 3) [m], whose z is counted from the target
    std: Floats  # (...) [m] root of R, or
    share: Floats  # (...) of the expected range


def reading_of(z: ArrayLike, rows: ArrayLike, std: ArrayLike, share: ArrayLike = 0.0) -> Reading:
    """Of scalars or arrays that broadcast."""
    z = np.asarray(z, dtype=np.float64)
    return Reading(
        z,
        np.broadcast_to(np.asarray(rows, dtype=np.int64), z.shape),
        np.broadcast_to(np.asarray(std, dtype=np.float64), z.shape),
        np.broadcast_to(np.asarray(share, dtype=np.float64), z.shape),
    )


def listen(told: Recent, reading: Reading, t: float, places: Floats, config: HybridConfig) -> Recent:
    """Least squares with one range more; ranges that contradict each other give none."""
    d = np.sqrt(np.maximum(np.square(reading.z) - np.square(places[reading.rows, 2]), 0.0))  # in the plane
    std = np.sqrt(np.square(reading.std) + np.square(reading.share * d))
    told = recent.hear(told, reading.rows, d, 1.0 / np.maximum(np.square(2.0 * d * std), 1e-12), t)
    place, age_max = places[:, :2], config.least_squares.age_max * config.period
    raw = recent.solve(told, place, t, age_max, bool(np.any(reading.share > 0.0)))
    off = recent.misfit(told, place, raw, t, age_max, config.start.velocity_std)
    with np.errstate(invalid='ignore'):
        raw = np.where((off > config.start.misfit * np.nan_to_num(std, nan=np.inf))[..., None], np.nan, raw)
    return recent.follow(told, raw, t, age_max, config.least_squares.weight)


def is_fresh(told: Recent, t: float, places: Floats, config: HybridConfig) -> Mask:
    """Whether least squares may correct a filter (...): of young ranges, and there for some periods."""
    age = config.manoeuvre.fresh * config.period
    lasted = t - told.since >= age * (1.0 - 1e-9)  # NaN: False
    return lasted & ~np.isnan(recent.solve(told, places[:, :2], t, age)[..., 0])
