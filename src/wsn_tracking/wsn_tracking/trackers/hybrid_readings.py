"""From an epoch's measurements to distances in the order in which they were measured (system D)."""

from __future__ import annotations

import math
from collections import Counter
from typing import NamedTuple

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.radio import MIN_RANGE, range_at, relative_range_std
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi

UNSET_NS = 60_000_000_000  # from this stamp of an epoch on, one of zero is no time of a measurement


class Distance(NamedTuple):
    """What one node told."""

    stamp_ns: int
    node_id: int
    row: int  # of the table of nodes
    z: float  # [m], freed of its radio's scale and bias
    std: float  # [m] of its error, or
    share: float  # of the distance: from signal strengths the error grows with it


class DistanceTable:
    """The nodes of one field; what cannot be used is counted by reason."""

    def __init__(self, anchors: Anchors, range_std: float) -> None:
        self.anchors = anchors
        self._range_std = range_std
        self._rows = {node: row for row, node in enumerate(anchors.ids.tolist())}
        self._share = relative_range_std(anchors).tolist()

    def read(self, epoch: Epoch, counters: Counter[str]) -> list[Distance]:
        """Every usable range or signal strength of the epoch's target, by time of measurement, then node.

        A stamp of zero, far from the epoch's, is none (a driver that sets no time): the epoch's counts.
        """
        told = []
        for packet in epoch.measurements:
            if packet.target_id != epoch.target_id:
                counters['other_target'] += 1
            elif packet.node_id not in self._rows:
                counters['unknown_node'] += 1
            elif not isinstance(packet, (Range, Rssi)) or not usable(packet):
                counters['unusable'] += 1
            else:
                unset = packet.stamp_ns == 0 and epoch.stamp_ns > UNSET_NS
                stamped = packet._replace(stamp_ns=epoch.stamp_ns) if unset else packet
                told.append(self._distance(stamped, self._rows[packet.node_id]))
        return sorted(told, key=lambda d: (d.stamp_ns, d.row))

    def _distance(self, packet: Range | Rssi, row: int) -> Distance:
        share = self._share[row]
        if isinstance(packet, Rssi):
            one = self.anchors.select(packet.node_id)
            z = float(range_at(one, packet.rssi_dbm)[0])
            if not math.isnan(packet.sigma_db):
                share *= packet.sigma_db / float(one.sigma_db[0])
            return Distance(packet.stamp_ns, packet.node_id, row, z, 0.0, share)
        scale, bias = float(self.anchors.scale[row]), float(self.anchors.bias[row])
        z = max((packet.range - bias) / scale, MIN_RANGE)
        std = math.sqrt(packet.variance) / scale
        if packet.modality == Modality.RSSI:
            return Distance(packet.stamp_ns, packet.node_id, row, z, 0.0, share if math.isnan(std) else std / z)
        return Distance(packet.stamp_ns, packet.node_id, row, z, self._range_std if math.isnan(std) else std, 0.0)
