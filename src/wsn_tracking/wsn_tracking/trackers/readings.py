"""From an epoch's measurements to what a filter updates with."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.measurement import (
    Function,
    constant_noise,
    log_range_function,
    mapped_noise,
    mapped_rssi_function,
    range_function,
    rssi_function,
)
from wsn_tracking.models.radio import relative_range_std
from wsn_tracking.models.radio_map import RadioMap, aligned
from wsn_tracking.sensing.average import usable, without_bearings
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi
from wsn_tracking.trackers.random_q_config import UpdateConfig


class Readings(NamedTuple):
    """One epoch over all nodes of a table."""

    z: Floats  # (N,), NaN where nothing usable was heard
    h: Function  # states (..., K, n) -> (..., K, N)
    noise: Function  # root of the noise, likewise
    ids: tuple[int, ...]  # the nodes that were heard


class MeasurementTable:
    """From an epoch's measurements to z, h and noise over all nodes (seed 000, algorithm 1, steps 4 to 6)."""

    def __init__(
        self, anchors: Anchors, height: float, update: UpdateConfig, radio_map: RadioMap | None = None
    ) -> None:
        self.anchors = anchors
        self._rows = {node: row for row, node in enumerate(anchors.ids.tolist())}
        self._share = relative_range_std(anchors)
        self._range = range_function(anchors, height)
        self._log_range = log_range_function(anchors, height)
        self._map = None if radio_map is None else aligned(radio_map, anchors)
        self._rssi = rssi_function(anchors, height)
        if self._map is not None:
            self._rssi = mapped_rssi_function(anchors, self._map, height)
        self._update = update

    def read(self, epoch: Epoch) -> Readings:
        """The readings of an epoch; a packet of an unknown node or with an impossible number is none."""
        kept = [
            (self._rows[p.node_id], p)
            for p in without_bearings(epoch).measurements
            if isinstance(p, (Range, Rssi)) and p.node_id in self._rows and usable(p)
        ]
        ids = tuple(p.node_id for _, p in kept)
        z = np.full(self.anchors.ids.size, np.nan)
        if kept and isinstance(kept[0][1], Rssi):
            std = (self.anchors.sigma_db if self._map is None else self._map.packet_db).copy()
            for row, p in kept:
                if isinstance(p, Rssi):
                    z[row] = p.rssi_dbm
                    std[row] = std[row] if np.isnan(p.sigma_db) else p.sigma_db
            noise = constant_noise(std) if self._map is None else mapped_noise(self._map, std)
            return Readings(z, self._rssi, noise, ids)
        variance = np.full(z.size, np.nan)
        for row, p in kept:
            if isinstance(p, Range):
                z[row], variance[row] = p.range, p.variance
        from_rssi = bool(kept) and all(isinstance(p, Range) and p.modality == Modality.RSSI for _, p in kept)
        return Readings(*self.ranges(z, np.sqrt(variance), from_rssi), ids)

    def ranges(self, z: Floats, told: Floats, from_rssi: bool) -> tuple[Floats, Function, Function]:
        """What the filter updates with, h and noise root, for ranges z and told noise roots, both (..., N) [m].

        NaN in z: not heard; in `told`: not known. A range from RSSI has an error that grows with it; any other has
        the one that came along.
        """
        h = self._range
        default = self._share * z if from_rssi else self._update.range_std
        std = np.where(np.isnan(told), default, told)
        if self._update.kind == 'log':
            return np.log(z), self._log_range, constant_noise(std / z)
        if from_rssi and self._update.r == 'predicted':
            share = std / z
            return z, h, lambda x: share[..., None, :] * h(x)
        return z, h, constant_noise(std)
