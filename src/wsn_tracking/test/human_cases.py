"""What the tests of system C share: a short c_walk, a tracker of few particles, and nonsense to feed it."""

import math

import numpy as np
import pytest

from wsn_tracking.sensing.values import NAN, Epoch, RangeBearing, Rssi
from wsn_tracking.simulation.c_body import BodyConfig, body_scenario, nodes
from wsn_tracking.simulation.record import START_NS, TARGET, record
from wsn_tracking.trackers.estimate import check_usable
from wsn_tracking.trackers.human_config import PROFILES, HumanConfig, StartConfig

SECOND = 1_000_000_000
AREA = (0.0, 0.0, 100.0, 100.0)
ANCHORS = nodes(BodyConfig())
FEW = HumanConfig(particles=200, area=AREA, start=StartConfig(draws=1000))
PROFILE = pytest.mark.parametrize('profile', sorted(PROFILES))


def epochs(config=None, seed=1):
    """The epochs of a short c_walk, and where he was."""
    scenario = body_scenario('c_walk', config or BodyConfig(duration=20.0), seed)
    by_epoch = {k: [] for k in range(len(scenario.truth))}
    for m in record(scenario, seed).messages:
        if isinstance(m, Rssi):
            by_epoch[m.request_seq].append(m)
    stamps = [START_NS + round(k * scenario.period * SECOND) for k in by_epoch]
    return [Epoch(TARGET, k, t, tuple(by_epoch[k])) for k, t in zip(by_epoch, stamps, strict=True)], scenario.truth


EPOCHS, TRUTH = epochs()


def run(tracker, sequence=EPOCHS):
    """What a tracker tells of each epoch."""
    return [tracker.step(epoch) for epoch in sequence]


def packet(node, dbm, k=0, sigma=NAN):
    """A reading [dBm] of a node in epoch k."""
    return Rssi(START_NS, node, TARGET, k, k, dbm, sigma)


def bounded(estimates, area=AREA):
    """That estimates are usable and lie in the area, with no more variance than it has room for."""
    width, depth = area[2] - area[0], area[3] - area[1]
    for estimate in estimates:
        check_usable(estimate)
        assert area[0] - 1e-9 <= estimate.mean[0] <= area[2] + 1e-9
        assert area[1] - 1e-9 <= estimate.mean[1] <= area[3] + 1e-9
        assert np.trace(estimate.covariance[:2, :2]) <= 0.25 * (width**2 + depth**2) + 1e-3
        assert np.trace(estimate.covariance[2:, 2:]) < 100.0


NONSENSE = {
    'nothing': lambda k: (),
    'one_node': lambda k: (packet(6, -60.0),),
    'impossible': lambda k: (packet(1, 127.0), packet(2, -128.0), packet(3, NAN), packet(4, math.inf)),
    'at_the_limits': lambda k: tuple(packet(i, (-127.0, 20.0)[(i + k) % 2]) for i in range(1, 17)),
    'exact': lambda k: tuple(packet(i, -70.0 - k, sigma=1e-9) for i in range(1, 17)),
    'strangers': lambda k: (packet(99, -60.0), RangeBearing(START_NS, 1, TARGET, k, k, 3.0, 0.1, (1.0, 0.0, 0.0, 1.0))),
    'far_away': lambda k: tuple(packet(i, -120.0) for i in range(1, 17)),
    'everywhere_at_once': lambda k: tuple(packet(i, -46.0) for i in range(1, 17)),
}
