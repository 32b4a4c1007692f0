"""Epochs of e_loss, of which three readings in ten are lost, and trackers of system E."""

from collections import Counter

import numpy as np

from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers.loss_tolerant import LossTolerantTracker
from wsn_tracking.trackers.loss_tolerant_config import TurningStartConfig

SECOND = 1_000_000_000
FILTERS = ('ckf', 'ekf', 'ukf', 'hold')
GIVEN = TurningStartConfig(kind='given', mean=(20.0, 25.0, 2.5, 1.7))
WORLD = e_loss(LossConfig(loss=0.3))
ANCHORS = WORLD.anchors


def epochs(loss=0.3, seed=1):
    """Epochs of the scenario, and where the target was."""
    world = e_loss(LossConfig(loss=loss, seed=seed))
    return list(epochs_of(record(world, seed), 1, Counter())), world.truth


def tracked(config, given, anchors=ANCHORS):
    """The estimates of these epochs, and the tracker that made them."""
    tracker = LossTolerantTracker(config, anchors)
    return [tracker.step(epoch)[0] for epoch in given], tracker


def errors(estimates, truth):
    """Distances (K,) [m]."""
    return np.array([np.hypot(*(e.mean[:2] - x[:2])) for e, x in zip(estimates, truth, strict=True)])


def is_usable(estimate):
    """Whether an estimate is finite and definite."""
    P = estimate.covariance
    return bool(np.all(np.isfinite(estimate.mean)) and np.all(np.isfinite(P)) and np.linalg.eigvalsh(P)[0] > 0.0)


EPOCHS, TRUTH = epochs()
