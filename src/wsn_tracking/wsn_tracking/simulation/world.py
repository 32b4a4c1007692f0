"""A world of one target and its radio field, epoch by epoch or whole and batched."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.measurement import distances
from wsn_tracking.models.radio import MIN_RANGE, rssi_at
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.scenario import Scenario

WORLD = 2**32  # the world's stream of draws; nodes and estimators use their ids


def noisy_ranges(scenario: Scenario, states: Floats, normals: Floats) -> Floats:
    """Ranges (..., N) [m] to states (..., 4), noise a share of the distance; normals (..., N) are N(0, 1)."""
    d = distances(scenario.anchors, states)
    return np.maximum(d * (1.0 + scenario.range_noise * normals), MIN_RANGE)


def rssi_of_epoch(scenario: Scenario, k: int, seed: int) -> Floats:
    """What every node reads in epoch k, (N,) [dBm]: the RSSI of the noisy range that will be told."""
    normals = keyed(seed, WORLD, k).standard_normal(scenario.anchors.ids.size)
    return rssi_at(scenario.anchors, noisy_ranges(scenario, scenario.truth[k], normals))


def rssi_packets(scenario: Scenario, seed: int, target_id: int, stamps: Sequence[int]) -> Iterator[Sequence[Rssi]]:
    """One packet of every node, epoch by epoch."""
    ids = scenario.anchors.ids.tolist()
    for k, stamp in enumerate(stamps):
        rssi = rssi_of_epoch(scenario, k, seed).tolist()
        yield [Rssi(stamp, node, target_id, k, k, dbm) for node, dbm in zip(ids, rssi, strict=True)]
