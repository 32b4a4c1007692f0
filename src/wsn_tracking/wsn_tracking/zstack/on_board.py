"""The trigger that runs on a mote, where signal strengths are not yet rounded: what it is, not how it decides."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple


class Thresholds(NamedTuple):
    """What a sensing command sets: service radius [dBm], smallest and largest change that is sent [dB]."""

    y_min: float
    e_min: float
    e_max: float


Judge = Callable[[Thresholds, float, float], tuple[float, bool]]
"""(thresholds, filtered signal so far, NaN at first, signal heard) -> (filtered signal, whether it is sent)."""


def in_radius(thresholds: Thresholds, yhat: float, y: float) -> tuple[float, bool]:
    """Whatever is not weaker than the service radius: motes without a trigger."""
    return yhat, y >= thresholds.y_min
