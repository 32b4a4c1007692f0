"""Two robots in phase through the whole loop: ranges, trackers, feedback over the network, wheels (seed 001)."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.draws import keyed
from wsn_tracking.parameters import group, param
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.simulation import d_cells
from wsn_tracking.simulation.d_cells import CellsConfig, Ranging
from wsn_tracking.simulation.driven import FIRST, SECOND, DrivenRobot, FollowConfig, phase_error
from wsn_tracking.simulation.record import START_NS
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig

CM = 0.01  # [m] feedback is told in whole centimetres
LINK = d_cells.CELLS + 1000  # the stream of draws of the network's way down
SETTLED_S = 15.0  # the second robot begins a third of a turn behind


@dataclass(frozen=True)
class PhaseConfig:
    """The whole loop."""

    cells: CellsConfig = group(CellsConfig)
    hybrid: HybridConfig = group(HybridConfig)
    follow: FollowConfig = group(FollowConfig)
    behind: float = param(2.0, 'how far the second robot is behind at first', 'rad', -3.14, 3.14)
    every: int = param(2, 'feedback of both robots is sent in every so many periods', 'periods', 1, 1000)
    delay: float = param(0.06, 'of the feedback, from the instant that it tells of', 's', 0.0, 10.0)
    loss: float = param(0.0, 'share of the feedback that is lost', '', 0.0, 1.0)
    told: str = param(
        'estimates', 'what is fed back; truth: as a perfect tracker would', choices=('estimates', 'truth')
    )


class PhaseRun(NamedTuple):
    """What happened, period by period."""

    times: Floats  # (K,) [s]
    truth: Floats  # (2, K, 4) of the first and the second robot
    estimates: Floats  # (2, K, 2) [m]; NaN until a track has begun
    error: Floats  # (K,) [rad] how far the second is really behind


def run(config: PhaseConfig, seed: int) -> PhaseRun:
    """One run of d_phase whose second robot drives by what it is told."""
    scenario = d_cells.d_phase(config.cells)
    anchors, T, epochs = scenario.anchors, config.cells.period, len(scenario.truth)
    second = DrivenRobot(config.follow, -config.behind)
    trackers = {target: HybridTracker(config.hybrid, anchors, target) for target in (FIRST, SECOND)}
    ranging = {target: Ranging(config.cells) for target in (FIRST, SECOND)}
    truth, estimates = np.empty((2, epochs, 4)), np.full((2, epochs, 2), np.nan)
    on_its_way: deque[tuple[float, int, Floats]] = deque()
    for k in range(epochs):
        t = k * T
        while on_its_way and on_its_way[0][0] <= t:
            told_at, target, position = on_its_way.popleft()
            second.hear(target, position, told_at)
        second.advance(t)
        truth[0, k], truth[1, k] = scenario.truth[k], second.state
        for target, tracker in trackers.items():
            at = truth[target - 1, k]
            rows, z = ranging[target].step(k, at, *d_cells.draws(seed, target, k))
            stamp = START_NS + round(t * 1e9)
            node = int(anchors.ids[rows])
            packet = Range(stamp, node, target, k, k, int(Modality.ULTRASOUND), float(z), config.cells.range_std**2)
            (estimate,) = tracker.step(Epoch(target, k, stamp, () if np.isnan(z) else (packet,)))
            if estimate.kind != Kind.START:
                estimates[target - 1, k] = estimate.mean[:2]
            told = at[:2] if config.told == 'truth' else estimates[target - 1, k]
            lost = keyed(seed, LINK + target, k).random() < config.loss
            if k % config.every == 0 and not lost and not np.isnan(told[0]):
                on_its_way.append((t + config.delay, target, CM * np.round(told / CM)))
    error = phase_error(config.follow, truth[0, :, :2], truth[1, :, :2])
    return PhaseRun(np.arange(epochs) * T, truth, estimates, error)
