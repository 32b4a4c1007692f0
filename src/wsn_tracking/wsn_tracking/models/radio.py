"""The log-distance radio channel, and what its scatter means for a range."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Anchors, Floats

MIN_RANGE = 0.01  # [m] no radio resolves less; keeps the logarithm finite
MAX_DECADES = 8.0  # beyond d0, of a range: what is read as further away says only that, and squares of it are numbers
LN10_10 = np.log(10.0) / 10.0


def rssi_at(anchors: Anchors, distances: ArrayLike) -> Floats:
    """Mean signal strength [dBm] at distances (..., N) [m] (seed 000, eq. 5)."""
    d = np.maximum(np.asarray(distances, dtype=np.float64), MIN_RANGE)
    return anchors.p1_dbm - 10.0 * anchors.n * np.log10(d / anchors.d0)


def range_at(anchors: Anchors, rssi_dbm: ArrayLike) -> Floats:
    """Range (..., N) [m] at which the mean signal strength is rssi_dbm (..., N): eq. 5 solved for z."""
    exponent = (anchors.p1_dbm - np.asarray(rssi_dbm, dtype=np.float64)) / (10.0 * anchors.n)
    return np.maximum(anchors.d0 * 10.0 ** np.minimum(exponent, MAX_DECADES), MIN_RANGE)


def relative_range_std(anchors: Anchors) -> Floats:
    """Standard deviation of an RSSI range, as a share of the range, (N,).

    ln z has the standard deviation sigma_db ln(10) / (10 n); with 1.56 dB and n = 3 that is the 0.12 of seed 000.
    """
    return np.asarray(anchors.sigma_db * LN10_10 / anchors.n)
