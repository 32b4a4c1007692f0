"""When a sensing node sends: the strategies, each a pure step over any leading axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.sensing.values import Reason

SENT = 0  # the verdict of a node that sends; any other is a Reason

Verdicts = NDArray[np.int64]
Trigger = Callable[[Floats, Floats, Floats], tuple[Floats, Verdicts]]
"""(yhat, y, uniform draws), each (..., N) -> (next yhat, verdicts). NaN in y: not heard; in yhat: never heard."""


class EventThresholds(NamedTuple):
    """Parameters of the event trigger (seed 000, eq. 1 and 2)."""

    y_min: float = -55.0  # [dBm] service radius
    e_min: float = 0.2  # [dB] below: nothing has changed
    e_max: float = 0.6  # [dB] above: noise
    alpha: float = 0.27  # pre-filter


def event(thresholds: EventThresholds) -> Trigger:
    """Send when in radius and when the signal has changed, but not wildly (seed 000, eq. 1 and 2).

    yhat <- alpha yhat + (1 - alpha) y on every request that is heard, sent or not; it starts at the first y.
    """
    y_min, e_min, e_max, alpha = thresholds

    def step(yhat: Floats, y: Floats, u: Floats) -> tuple[Floats, Verdicts]:
        heard = ~np.isnan(y)
        prefiltered = np.where(np.isnan(yhat), y, alpha * yhat + (1.0 - alpha) * y)
        change = np.abs(y - prefiltered)
        verdict = _verdicts(
            (~heard, Reason.NOT_HEARD),
            (~(y > y_min), Reason.OUT_OF_RADIUS),
            (~(change > e_min), Reason.UNCHANGED),
            (~(change < e_max), Reason.NOISY),
        )
        return np.where(heard, prefiltered, yhat), verdict

    return step


def near(y_min: float) -> Trigger:
    """Send whenever in radius: eq. 1 alone."""

    def step(yhat: Floats, y: Floats, u: Floats) -> tuple[Floats, Verdicts]:
        return yhat, _verdicts((np.isnan(y), Reason.NOT_HEARD), (~(y > y_min), Reason.OUT_OF_RADIUS))

    return step


def always() -> Trigger:
    """Send whatever is heard."""
    return near(-np.inf)


def random(rate: float) -> Trigger:
    """Send what is heard with a fixed probability: the control that the other triggers must beat."""

    def step(yhat: Floats, y: Floats, u: Floats) -> tuple[Floats, Verdicts]:
        return yhat, _verdicts((np.isnan(y), Reason.NOT_HEARD), (~(u < rate), Reason.NOT_DRAWN))

    return step


def _verdicts(*reasons: tuple[Mask, Reason]) -> Verdicts:
    """The first reason that applies to each node; SENT where none does."""
    verdict = np.full(reasons[0][0].shape, SENT)
    for applies, reason in reversed(reasons):
        verdict = np.where(applies, int(reason), verdict)
    return verdict
