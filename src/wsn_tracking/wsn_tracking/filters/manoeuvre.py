"""Has a target changed its motion? The innovations say, and least squares where it is instead (seed 001, section 2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.filters.ekf import Innovation, gain
from wsn_tracking.models.anchors import Floats, Mask


class Watch(NamedTuple):
    """The last innovations and the rest after a manoeuvre, counted in ranges."""

    squared: Floats  # (..., n) nu^2 / S of the last n ranges, zero before there were any
    rest: NDArray[np.int64]  # (...) ranges until a manoeuvre can be found again


def calm(shape: tuple[int, ...], length: int) -> Watch:
    """Before anything was heard; shape of the batch."""
    return Watch(np.zeros((*shape, length)), np.zeros(shape, dtype=np.int64))


def observe(watch: Watch, seen: Innovation, threshold: float) -> tuple[Watch, Mask]:
    """Take one range in, and say where the sum of the last n, chi-squared of n, is beyond the threshold.

    No range counts for more than half of it: one that is wrong is no manoeuvre.
    """
    heard = ~np.isnan(seen.nu)
    told = np.where(heard, np.minimum(seen.squared, 0.5 * threshold), 0.0)
    shifted = np.concatenate([watch.squared[..., 1:], told[..., None]], axis=-1)
    squared = np.where(heard[..., None], shifted, watch.squared)
    rest = np.maximum(watch.rest - heard, 0)
    return Watch(squared, rest), heard & (rest == 0) & (squared.sum(axis=-1) > threshold)


def answered(watch: Watch, where: Mask, rest: int) -> Watch:
    """A manoeuvre was answered there: what was seen before no longer counts, and the next is `rest` ranges off."""
    return Watch(np.where(where[..., None], 0.0, watch.squared), np.where(where, rest, watch.rest))


def error_covariance(m: Floats, x_ls: Floats, position_std: float, velocity_std: float) -> Floats:
    """P_z = e e' + diag(position_std^2 x 2, velocity_std^2 x 2) (..., 4, 4), e = least squares minus prediction."""
    e = x_ls - m
    floor = np.diag(np.square([position_std, position_std, velocity_std, velocity_std]))
    return np.asarray(e[..., :, None] * e[..., None, :] + floor)


def with_extra(K: Floats, K_z: Floats, g: Floats) -> Floats:
    """K + K_z (..., n), shortened where it would go beyond what the range says: H (K + K_z) at most one."""
    total = K + K_z
    along = np.sum(total[..., :2] * g, axis=-1)
    return np.asarray(total / np.maximum(along, 1.0)[..., None])


def extra_gain(P_z: Floats, seen: Innovation) -> Floats:
    """K_z = P_z H' / (H P_z H' + R) with the current H (seed 001, eq. 14)."""
    return gain(P_z, seen.g, seen.R)
