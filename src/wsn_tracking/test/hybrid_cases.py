"""What the tests of system D share: epochs of walks in its field."""

from __future__ import annotations

from collections import Counter

import numpy as np

from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig

PERIOD_NS = 50_000_000
S = 1_000_000_000
ANCHORS = scenario('d_stop').anchors
LINE = np.column_stack([1.0 + 0.01 * np.arange(160), np.full(160, 1.3)])
RESTING = np.tile([1.3, 2.6], (120, 1))
ON_TRACK = 0.1  # [m] five times the noise of a range: at no instant may an estimate be further off


def recorded(name, seed=1, target=1, **settings):
    """Epochs of a scenario and the truth at each."""
    recording = record(scenario(name, settings), seed)
    epochs = list(epochs_of(recording, target, Counter()))
    return epochs, recording.truth[target].positions[:, :2]


def epoch_of(k, ranges, target=1, period_ns=PERIOD_NS):
    """An epoch of ranges by row of ANCHORS."""
    stamp = k * period_ns
    packets = tuple(
        Range(stamp, int(ANCHORS.ids[row]), target, k, k, Modality.ULTRASOUND, float(z)) for row, z in ranges
    )
    return Epoch(target, k, stamp, packets)


def walk_of(places, seed=1, noise=0.02, each=1, anchors=ANCHORS, z=None):
    """Epochs of `each` ranges, of nodes in turn, to a target at places (K, 2); z [m]: its height."""
    rng = np.random.default_rng(seed)
    epochs = []
    for k, x in enumerate(places):
        rows = [(k * each + i) % anchors.ids.size for i in range(each)]
        d = np.linalg.norm(np.array([*x, z or 0.0]) - anchors.positions[rows], axis=-1)
        epochs.append(epoch_of(k, zip(rows, d + noise * rng.standard_normal(each), strict=True)))
    return epochs


def moved(epoch, stamp_ns):
    """The epoch and its ranges at another instant."""
    return epoch._replace(
        stamp_ns=stamp_ns, measurements=tuple(p._replace(stamp_ns=stamp_ns) for p in epoch.measurements)
    )


def misread(epoch, reading):
    """The epoch, each of its ranges z read as reading(z)."""
    return epoch._replace(measurements=tuple(p._replace(range=reading(p.range)) for p in epoch.measurements))


def tracked(epochs, config=None, anchors=ANCHORS, target=1):
    """A tracker after these epochs, and its estimates."""
    tracker = HybridTracker(config or HybridConfig(), anchors, target)
    return tracker, [tracker.step(epoch)[0] for epoch in epochs]


def errors(estimates, truth):
    """Distances (K,) [m]."""
    return np.linalg.norm(np.array([e.mean[:2] for e in estimates]) - truth, axis=-1)
