"""What one node has read in an epoch, as z and R of range and bearing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.radio import range_at, relative_range_std
from wsn_tracking.sensing.average import USABLE_M, USABLE_STD, usable
from wsn_tracking.sensing.values import NAN, Epoch, Measurement, Range, RangeBearing, Rssi


class Observation(NamedTuple):
    """One node's reading."""

    z: Floats  # (2,) range [m], bearing [rad]; NaN: not read
    R: Floats  # (2, 2)


def observation_of(epoch: Epoch, anchor: Anchors, default_R: Floats) -> Observation:
    """The reading of the one node in `anchor`; noise that is not told is default_R (2, 2).

    A measured range is freed of its radio's scale and bias; a signal strength becomes the range of its path loss.
    """
    node = int(anchor.ids[0])
    packet = next((p for p in epoch.measurements if p.node_id == node and usable(p)), None)
    if isinstance(packet, Rssi):
        distance = float(range_at(anchor, packet.rssi_dbm)[0])
        sigma = 1.0 if math.isnan(packet.sigma_db) else packet.sigma_db / float(anchor.sigma_db[0])
        std = sigma * float(relative_range_std(anchor)[0]) * distance
        return Observation(np.array([distance, NAN]), _with_range_variance(default_R, std**2))
    z, R = _told(packet, default_R)
    scale, bias = float(anchor.scale[0]), float(anchor.bias[0])
    unit = np.array([1.0 / scale, 1.0])
    return Observation((z - np.array([bias, 0.0])) * unit, R * np.outer(unit, unit))


def _told(packet: Measurement | None, default_R: Floats) -> Observation:
    if isinstance(packet, Range):
        R = default_R if math.isnan(packet.variance) else _with_range_variance(default_R, packet.variance)
        return Observation(np.array([packet.range, NAN]), R)
    if isinstance(packet, RangeBearing) and packet.arrived:
        z = np.array([packet.range, packet.bearing])
        z[~(np.abs(z) < USABLE_M[1])] = NAN
        R = np.array(packet.covariance).reshape(2, 2)
        return Observation(z, R if _is_covariance(R) else default_R)
    return Observation(np.full(2, NAN), default_R)


def _with_range_variance(R: Floats, variance: float) -> Floats:
    return np.diag([variance, R[1, 1]])


def _is_covariance(R: Floats) -> bool:
    """Whether R (2, 2) is symmetric, positive definite and of deviations that a reading can have."""
    low, high = USABLE_STD
    in_range = np.all((np.diag(R) >= low**2) & (np.diag(R) < high**2))
    return bool(in_range and R[0, 1] == R[1, 0] and R[0, 1] ** 2 < R[0, 0] * R[1, 1])
