"""Measurement functions, one column a node, and the noise that belongs to each.

A function maps planar states (..., K, n) to what all N nodes should read (..., K, N). Each looks at the position
alone, the first two states (POSITION). A target moves at a known height, so that distances are three-dimensional.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio import MIN_RANGE, relative_range_std, rssi_at
from wsn_tracking.models.radio_map import RadioMap, residual_mean, residual_std

Function = Callable[[Floats], Floats]
POSITION = 2  # leading states that a measurement function of this module looks at


def distances(anchors: Anchors, states: Floats, height: float = 0.0) -> Floats:
    """Distance of every state (..., n) to every node, (..., N) [m], at least MIN_RANGE."""
    return distance_function(anchors, height)(states)


def distance_function(anchors: Anchors, height: float = 0.0) -> Function:
    """The same with the nodes' columns laid out once, for whoever asks at every step."""
    x, y = np.ascontiguousarray(anchors.positions[:, 0]), np.ascontiguousarray(anchors.positions[:, 1])
    dz_squared = np.square(height - anchors.positions[:, 2])
    planar = not dz_squared.any()
    least = np.array(MIN_RANGE)

    def d(states: Floats) -> Floats:
        dx, dy = states[..., :1] - x, states[..., 1:2] - y
        squared = np.multiply(dx, dx, out=dx)
        squared += np.multiply(dy, dy, out=dy)
        if not planar:
            squared += dz_squared
        return np.asarray(np.maximum(np.sqrt(squared, out=squared), least, out=squared))

    return d


def range_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = scale d(x) + bias [m] (seed 000, eq. 4, with the calibration of a ranging radio)."""
    d = distance_function(anchors, height)
    if np.all(anchors.scale == 1.0) and not anchors.bias.any():
        return d
    return lambda x: np.maximum(anchors.scale * d(x) + anchors.bias, MIN_RANGE)


def log_range_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = ln(scale d(x) + bias): RSSI noise is additive and even in this domain."""
    h = range_function(anchors, height)
    return lambda x: np.log(h(x))


def rssi_function(anchors: Anchors, height: float = 0.0) -> Function:
    """h(x) = signal strength [dBm] (seed 000, eq. 5)."""
    d = distance_function(anchors, height)
    return lambda x: rssi_at(anchors, d(x))


def mapped_rssi_function(anchors: Anchors, radio_map: RadioMap, height: float = 0.0) -> Function:
    """h(x) = signal strength [dBm] by a map whose columns are the anchors': its path loss and what is about that."""
    ones = np.ones(anchors.ids.size)
    h = rssi_function(anchors._replace(p1_dbm=radio_map.p1_dbm, n=radio_map.n, d0=ones), height)
    return lambda x: h(x) + residual_mean(radio_map, x)


def mapped_noise(radio_map: RadioMap, packet_db: Floats) -> Function:
    """Noise root [dB] of signal strengths about the map: its own uncertainty, fading from place to place, packets.

    packet_db (..., N): standard deviation of the packets at one place, the map's or what came along.
    """
    fixed = np.square(radio_map.place_db) + np.square(packet_db)
    return lambda x: np.sqrt(np.square(residual_std(radio_map, x)) + fixed[..., None, :])


def relative_noise(anchors: Anchors, h: Function) -> Function:
    """Noise root of an RSSI range at a state: (0.12 h(x)) of seed 000, with each node's own share."""
    share = relative_range_std(anchors)
    return lambda x: share * h(x)


def constant_noise(std: Floats) -> Function:
    """Noise root (..., N) that does not depend on the state."""
    return lambda x: std[..., None, :]
