"""Measurement functions, one column a node, and the noise that belongs to each.

A function maps planar states (..., K, n) to what all N nodes should read (..., K, N). A target moves at a
known height, so that distances are three-dimensional.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio import MIN_RANGE, relative_range_std, rssi_at

Function = Callable[[Floats], Floats]


def distances(anchors: Anchors, states: Floats, height: float = 0.0) -> Floats:
    """Distance of every state (..., n) to every node, (..., N) [m], at least MIN_RANGE."""
    dx = states[..., 0, None] - anchors.positions[:, 0]
    dy = states[..., 1, None] - anchors.positions[:, 1]
    dz = height - anchors.positions[:, 2]
    return np.maximum(np.sqrt(dx * dx + dy * dy + dz * dz), MIN_RANGE)


def range_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = scale d(x) + bias [m] (seed 000, eq. 4, with the calibration of a ranging radio)."""
    return lambda x: np.maximum(anchors.scale * distances(anchors, x, height) + anchors.bias, MIN_RANGE)


def log_range_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = ln(scale d(x) + bias): RSSI noise is additive and even in this domain."""
    h = range_function(anchors, height)
    return lambda x: np.log(h(x))


def rssi_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = signal strength [dBm] (seed 000, eq. 5)."""
    return lambda x: rssi_at(anchors, distances(anchors, x, height))


def relative_noise(anchors: Anchors, h: Function) -> Function:
    """Noise root of an RSSI range at a state: (0.12 h(x)) of seed 000, with each node's own share."""
    share = relative_range_std(anchors)
    return lambda x: share * h(x)


def constant_noise(std: Floats) -> Function:
    """Noise root (..., N) that does not depend on the state."""
    return lambda x: std[..., None, :]
