"""What the tests of system A share: a start near the robot of a_loop, its epochs, and estimates to fuse."""

import math

import numpy as np
from oracles import LOOP, H

from wsn_tracking.sensing import trigger
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.studies.random_q_runs import repeated, sense
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.random_q import LocalEstimator
from wsn_tracking.trackers.random_q_config import RandomQConfig, StartConfig

IDS = LOOP.anchors.ids.tolist()
MEAN, STD = (0.65, 0.62, 0.06, 0.0), (0.1, 0.1, 0.06, 0.06)
Z = H(LOOP.truth[5])
GIVEN = RandomQConfig(start=StartConfig(kind='given', mean=MEAN, std=STD))


def epoch(k, z, **fields):
    """Ranges z (12,) [m] of RSSI, one second apart; NaN: not sent."""
    values = {'modality': Modality.RSSI, 'variance': math.nan, **fields}
    heard = [(i, float(r)) for i, r in zip(IDS, z, strict=True) if not np.isnan(r)]
    return Epoch(1, k, k * 10**9, tuple(Range(k * 10**9, i, 1, k, k, range=r, **values) for i, r in heard))


def epochs(seed=1, count=20):
    """The first epochs of a_loop behind its event trigger."""
    step = trigger.event(trigger.EventThresholds(alpha=LOOP.alpha))
    sensed = sense(LOOP, repeated(LOOP, 1), step, np.random.default_rng(seed))
    return [epoch(k, z) for k, z in enumerate(sensed.z[0, :count])]


def run(config, sequence, number=1):
    """The estimates of one local estimator."""
    estimator = LocalEstimator(config, LOOP.anchors, number)
    return [estimator.step(e) for e in sequence]


def locals_of(seed, count=3, k=0):
    """Estimates of `count` peers in epoch k, anywhere."""
    rng = np.random.default_rng(seed)
    roots = rng.standard_normal((count, 4, 4)) * 0.05 + 0.1 * np.eye(4)
    return [
        Estimate(k, 1, k, f'local_{i}', rng.standard_normal(4), L @ L.T, (i,), (i, i + 3), 7.0)
        for i, L in enumerate(roots, start=1)
    ]
