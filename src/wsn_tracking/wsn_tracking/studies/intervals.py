"""A figure of a study with its 95 % interval, from independent runs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from wsn_tracking.models.anchors import Floats

Figure = dict[str, float | list[float]]
NORMAL_95 = 1.959964  # the runs are many: their mean is all but normal


def mean_of(values: Floats, scale: float = 1.0) -> Figure:
    """Mean over runs (R,), times `scale`."""
    return _figure(float(np.mean(values)), float(np.std(values, ddof=1)) / np.sqrt(values.size), scale)


def ratio_of(above: Floats, below: Floats, root: bool = False) -> Figure:
    """Ratio of the means of two quantities of the same runs (R,); `root`: of the roots of the means.

    The interval is linearised about the ratio: what the pairs have in common cancels.
    """
    ratio = float(np.mean(above) / np.mean(below))
    error = float(np.std(above - ratio * below, ddof=1) / np.mean(below)) / np.sqrt(above.size)
    if root:
        return _figure(float(np.sqrt(ratio)), 0.5 * error / float(np.sqrt(ratio)), 1.0)
    return _figure(ratio, error, 1.0)


def change_of(value: Floats, base: Floats) -> Figure:
    """How far the mean of `value` lies above that of `base`, both of the same runs (R,), in percent."""
    ratio = float(np.mean(value) / np.mean(base))
    error = float(np.std(value - ratio * base, ddof=1) / np.mean(base)) / np.sqrt(value.size)
    return _figure(ratio - 1.0, error, 100.0)


def _figure(value: float, error: float, scale: float) -> Figure:
    low, high = value - NORMAL_95 * error, value + NORMAL_95 * error
    return {'value': short(scale * value), 'interval_95': [short(scale * low), short(scale * high)]}


def short(value: float | np.floating[Any], digits: int = 5) -> float:
    """So many digits: what lies beyond differs between machines and means nothing."""
    return float(f'{value:.{digits}g}')


def known(value: float | np.floating[Any], digits: int = 4) -> float | None:
    """The same; None where nothing is known: JSON has no NaN."""
    return short(value, digits) if math.isfinite(value) else None
