"""Ranges of ultra-wideband radios on a_loop, and an estimator of system A that starts where its robot does."""

import dataclasses

import numpy as np
from oracles import LOOP, H

from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.trackers.random_q import LocalEstimator
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, StartConfig

IDS = LOOP.anchors.ids.tolist()


def epoch(k, z, variance=0.01):
    """Ranges z (12,) [m] of ultra-wideband radios, one second apart; NaN: not heard."""
    heard = [(i, float(r)) for i, r in zip(IDS, z, strict=True) if not np.isnan(r)]
    stamp_ns = k * 10**9
    return Epoch(1, k, stamp_ns, tuple(Range(stamp_ns, i, 1, k, k, Modality.UWB, r, variance) for i, r in heard))


def estimator(**options):
    """Of system A, at the true start."""
    given = StartConfig(kind='given', mean=tuple(LOOP.truth[0]), epochs=1)
    acceleration = NoiseConfig(kind='acceleration')
    config = dataclasses.replace(RandomQConfig(start=given, noise=acceleration, area=LOOP.area), **options)
    return LocalEstimator(config, LOOP.anchors, 1)


def ranges(k, rng):
    """Noisy ranges (12,) to the robot in epoch k."""
    return H(LOOP.truth[k]) + 0.1 * rng.standard_normal(12)
