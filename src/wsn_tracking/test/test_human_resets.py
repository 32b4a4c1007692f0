"""A person who was silent or is elsewhere is looked for anew."""

from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, EPOCHS, FEW, SECOND, bounded, epochs, packet, run

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.simulation.record import TARGET
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import SignalConfig, StartConfig


@pytest.mark.parametrize('offsets', [False, True])
def test_after_a_long_silence_places_are_weighed_about_where_he_may_have_gone(offsets):
    """Twenty seconds of silence: what one node says then leaves places behind that the walk could not have reached."""
    signal = SignalConfig(kind='single', outlier=0.0, offset_std=2.0) if offsets else SignalConfig()
    start = StartConfig(draws=5000, reset_epochs=0)
    tracker = HumanTracker(replace(FEW, particles=500, signal=signal, start=start), ANCHORS)
    run(tracker, EPOCHS[:12])
    was = tracker._last.mean[:2]
    stamp = EPOCHS[11].stamp_ns
    for k in range(12, 53):
        stamp += SECOND // 2
        tracker.step(Epoch(TARGET, k, stamp, ()))
    spread = np.sqrt(np.trace(tracker._last.covariance[:2, :2]))
    assert np.unique(tracker.particles.positions, axis=0).shape[0] <= 500
    (estimate,) = tracker.step(Epoch(TARGET, 53, stamp + SECOND // 2, (packet(6, -70.0, 53),)))
    assert tracker.counters['reset'] == 1
    assert np.unique(tracker.particles.positions, axis=0).shape[0] > 300  # places of their own, not copies of a few
    far = np.hypot(*(tracker.particles.positions - was).T) > 4.0 * spread
    assert far.mean() < 0.35  # a fifth of the places are anywhere, and weigh as much as one epoch says
    bounded([estimate])
    never = HumanTracker(replace(FEW, start=replace(start, silence=0.0)), ANCHORS)
    run(
        never,
        [
            *EPOCHS[:12],
            Epoch(TARGET, 12, EPOCHS[11].stamp_ns + 50 * SECOND, ()),
            EPOCHS[13]._replace(stamp_ns=EPOCHS[11].stamp_ns + 51 * SECOND),
        ],
    )
    assert never.counters['reset'] == 0


def test_a_target_that_is_elsewhere_is_found_again_and_counted():
    config = BodyConfig(duration=60.0, teleport_at=30.0)
    sequence, truth = epochs(config, 2)
    tracker = HumanTracker(replace(FEW, particles=500, lag=1.0), ANCHORS)
    out = run(tracker, sequence)
    assert tracker.counters['reset'] >= 1
    assert np.hypot(*(out[-1][0].mean[:2] - truth[-1, :2])) < 8.0
    never = HumanTracker(replace(FEW, particles=500, start=StartConfig(reset_epochs=0)), ANCHORS)
    run(never, sequence)
    assert never.counters['reset'] == 0
