"""From an epoch's measurements to signal strengths over all nodes."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.models.body import Curve, Curves
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.radio import LN10_10
from wsn_tracking.sensing.average import usable, without_bearings
from wsn_tracking.sensing.channel import Body
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi
from wsn_tracking.trackers.human_config import HumanConfig
from wsn_tracking.trackers.human_models import curves_of

LEAST_SIGMA = 0.5  # [dB] of what is said to be exact: particles are not
RANGE_STD = 0.1  # [m] of a range that tells no variance


class SignalTable:
    """What every node of a table has read.

    A range becomes the signal strength that a node's single curve has there, its deviation likewise: the likelihood of
    such a reading is log-normal in the range. A body does not shade what was not measured by signal strength.
    """

    def __init__(self, config: HumanConfig, anchors: Anchors, counters: Counter[str], body: Body | None = None) -> None:
        self._anchors = anchors
        self._rows = {node: row for row, node in enumerate(anchors.ids.tolist())}
        self._curves = curves_of(config, anchors, body)
        self._fixed = config.signal.sigma
        self._extra = config.extra_db
        self._counters = counters

    def read(self, epoch: Epoch) -> tuple[Readings, tuple[int, ...]]:
        """Readings (N,), and the nodes that were heard; what cannot be used is counted."""
        z = np.full(self._anchors.ids.size, np.nan)
        sigma = self._anchors.sigma_db.copy()
        bodiless = np.zeros(z.size, dtype=np.bool_)
        for p in without_bearings(epoch).measurements:
            row = self._rows.get(p.node_id)
            if row is None or not usable(p) or not isinstance(p, (Rssi, Range)):
                self._counters['unknown_node' if row is None else 'unusable'] += 1
                continue
            if isinstance(p, Rssi):
                z[row], told = p.rssi_dbm, p.sigma_db
            else:
                z[row], told = self._of_range(row, p)
                bodiless[row] = p.modality != Modality.RSSI
            sigma[row] = sigma[row] if math.isnan(told) else max(told, LEAST_SIGMA)
        if self._fixed:
            sigma = np.where(bodiless, sigma, self._fixed)
        sigma = np.where(bodiless, sigma, np.hypot(sigma, self._extra))
        ids = tuple(self._anchors.ids[~np.isnan(z)].tolist())
        return Readings(z, sigma, _without_body(self._curves, bodiless)), ids

    def _of_range(self, row: int, p: Range) -> tuple[float, float]:
        """Signal strength and deviation that say the same as a range."""
        a, single = self._anchors, self._curves.single
        d = max((p.range - float(a.bias[row])) / float(a.scale[row]), 1e-2)
        std = RANGE_STD if math.isnan(p.variance) else math.sqrt(p.variance)
        if p.modality == Modality.RSSI and not math.isnan(p.rssi_dbm):
            told = math.nan if math.isnan(p.variance) else std / p.range / LN10_10 * float(a.n[row])
            return p.rssi_dbm, told
        if p.modality == Modality.RSSI and math.isnan(p.variance):
            return float(single.p_ref[row] + single.k[row] * math.log10(d)), math.nan
        share = std / float(a.scale[row]) / d
        return float(single.p_ref[row] + single.k[row] * math.log10(d)), share / LN10_10 * float(-single.k[row]) / 10.0


def _without_body(curves: Curves, where: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> Curves:
    """The single curve in the place of the others there."""
    if not where.any():
        return curves
    single = curves.single

    def replaced(curve: Curve) -> Curve:
        return Curve(np.where(where, single.p_ref, curve.p_ref), np.where(where, single.k, curve.k))

    return Curves(replaced(curves.los), replaced(curves.nlos), single)
