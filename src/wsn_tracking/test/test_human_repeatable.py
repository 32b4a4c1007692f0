"""Equal epochs give equal estimates, bit for bit, alone or in a batch."""

from dataclasses import replace

import numpy as np
from human_cases import ANCHORS, AREA, EPOCHS, FEW, PROFILE, run

from wsn_tracking.bags.estimates import differences
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.draws import keyed
from wsn_tracking.trackers.human import HUMAN, HumanTracker
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of


def flat(steps):
    return [estimate for step in steps for estimate in step]


@PROFILE
def test_two_trackers_agree_bit_for_bit_and_so_does_one_that_begins_anew(profile):
    config = replace(FEW, profile=profile, lag=1.0)
    tracker = HumanTracker(config, ANCHORS)
    first = flat(run(tracker))
    assert differences(first, flat(run(HumanTracker(config, ANCHORS)))) == []
    tracker.reset()
    assert differences(first, flat(run(tracker))) == []


def test_draws_belong_to_their_epoch():
    """A tracker that was asked for other things in between, or loses an epoch, draws what it would have drawn."""
    tracker, other = HumanTracker(FEW, ANCHORS), HumanTracker(FEW, ANCHORS)
    run(tracker, EPOCHS[:10])
    for epoch in EPOCHS[:10]:
        other.step(epoch)
        other.state()
    assert differences(tracker.step(EPOCHS[10]), other.step(EPOCHS[10])) == []
    assert tracker._draws.at(11).random() == keyed(FEW.seed, HUMAN, 11).random()
    reseeded = HumanTracker(replace(FEW, seed=1), ANCHORS)
    assert np.all(reseeded.particles.positions != HumanTracker(FEW, ANCHORS).particles.positions)


@PROFILE
def test_one_run_of_a_batch_is_a_run_alone(profile):
    config = replace(FEW, profile=profile)
    curves = curves_of(config, ANCHORS)
    alone, batch = (HumanFilter(config, ANCHORS, AREA) for _ in range(2))
    rngs = [np.random.default_rng(5) for _ in range(2)]
    a, b = alone.begin((), rngs[0]), batch.begin((1,), rngs[1])
    for epoch in EPOCHS[:12]:
        z = np.full(16, np.nan)
        z[[p.node_id - 1 for p in epoch.measurements]] = [p.rssi_dbm for p in epoch.measurements]
        sigma = np.full(16, 3.0)
        one = alone.step(a, 0.5, Readings(z, sigma, curves), rngs[0])
        many = batch.step(b, 0.5, Readings(z[None], sigma[None], curves), rngs[1])
        a, b = one.track, many.track
        np.testing.assert_allclose(many.mean[0], one.mean, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(many.evidence[0], one.evidence, rtol=1e-8)
