"""What the tracker of system E gives, epoch by epoch, and what lost readings cost it."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from loss_cases import EPOCHS, FILTERS, GIVEN, TRUTH, WORLD, epochs, errors, is_usable, tracked

from wsn_tracking.bags.estimates import differences
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig

MIDDLE = np.reshape(WORLD.area, (2, 2)).mean(axis=0)


@pytest.mark.parametrize('name', FILTERS)
def test_a_turning_target_is_tracked_from_an_unknown_start(name):
    """Its readings alone place a target to some 4 m at 30 % loss; 12 m would be lost."""
    estimates, tracker = tracked(LossTolerantConfig(filter=name), EPOCHS)
    assert np.sqrt(np.mean(errors(estimates, TRUTH)[5:] ** 2)) < 12.0
    assert tracker.state()['tracking']
    assert tracker.state()['arriving'] == pytest.approx(0.7, abs=0.15)
    assert all(is_usable(e) for e in estimates)


def test_an_estimate_says_what_it_is():
    estimates, tracker = tracked(LossTolerantConfig(start=GIVEN), EPOCHS)
    assert tracker.outputs == ('loss_tolerant',)
    for epoch, e in zip(EPOCHS, estimates, strict=True):
        assert (e.stamp_ns, e.target_id, e.request_seq) == (epoch.stamp_ns, epoch.target_id, epoch.request_seq)
        assert (e.source, e.state_names, e.kind) == ('loss_tolerant', ('x', 'y', 'vx', 'vy', 'w'), Kind.LOCAL)
        assert e.measurements == tuple(p.node_id for p in epoch.measurements)
        assert (e.mean.shape, e.covariance.shape) == ((5,), (5, 5))


def test_a_start_takes_its_epochs():
    estimates, _ = tracked(LossTolerantConfig(), EPOCHS[:6])
    assert [e.kind for e in estimates] == [Kind.START] * 4 + [Kind.LOCAL] * 2
    before, _ = tracked(LossTolerantConfig(), [EPOCHS[0]._replace(measurements=())] * 3 + EPOCHS[:6])
    assert [e.kind for e in before] == [Kind.START] * 7 + [Kind.LOCAL] * 2
    assert before[0].covariance[0, 0] > 30.0**2  # anywhere in the field


def test_it_depends_on_its_epochs_alone():
    """Twice the same tracker, after a reset, and a second one: bit for bit."""
    one, tracker = tracked(LossTolerantConfig(), EPOCHS)
    tracker.reset()
    assert differences(one, [tracker.step(epoch)[0] for epoch in EPOCHS]) == []
    assert differences(one, tracked(LossTolerantConfig(), EPOCHS)[0]) == []


@pytest.mark.parametrize('name', FILTERS)
def test_the_order_of_readings_does_not_matter(name):
    shuffled = [e._replace(measurements=e.measurements[::-1]) for e in EPOCHS[:20]]
    one, other = (tracked(LossTolerantConfig(filter=name), given)[0] for given in (EPOCHS[:20], shuffled))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.mean, b.mean)


@pytest.mark.parametrize('name', ['ckf', 'ekf', 'ukf'])
def test_an_epoch_without_readings_is_a_prediction(name):
    empty = EPOCHS[40]._replace(measurements=())
    estimates, tracker = tracked(LossTolerantConfig(filter=name), [*EPOCHS[:40], empty])
    before, after = estimates[-2:]
    assert (after.measurements, after.kind) == ((), Kind.LOCAL)
    assert np.linalg.det(after.covariance) > np.linalg.det(before.covariance)
    assert after.mean[:2] == pytest.approx(before.mean[:2] + before.mean[2:4], abs=0.5)
    assert (tracker.state()['silent_s'], tracker.state()['all_lost']) == (1.0, 1)
    assert not tracker.counters


def test_what_is_lost_only_costs_accuracy():
    """Rates of loss of 0, 0.5 and 0.9 over five walks: errors grow by more than their scatter."""
    rmse, guess = [], []
    for loss in (0.0, 0.5, 0.9):
        runs = [epochs(loss, seed) for seed in range(1, 6)]
        found = [errors(tracked(LossTolerantConfig(), given)[0], truth)[5:] for given, truth in runs]
        rmse.append(np.sqrt(np.mean(np.square(found))))
        guess += [np.hypot(*(truth[5:, :2] - MIDDLE).T) for _, truth in runs]
    assert all(a < b for a, b in pairwise(rmse))
    assert rmse[2] < 0.5 * np.sqrt(np.mean(np.square(guess)))  # of who says the middle of the field


def test_a_held_value_is_used_again_and_not_listed():
    """Node 1 is heard once: it pulls the track again and again, where it should be forgotten."""
    first = EPOCHS[0]
    rest = [e._replace(measurements=()) for e in EPOCHS[1:6]]
    held, _ = tracked(LossTolerantConfig(filter='hold', start=GIVEN), [first, *rest])
    fair, _ = tracked(LossTolerantConfig(start=GIVEN), [first, *rest])
    np.testing.assert_array_equal(held[0].mean, fair[0].mean)
    assert np.trace(held[-1].covariance[:2, :2]) < 0.5 * np.trace(fair[-1].covariance[:2, :2])
    assert [e.measurements for e in held[1:]] == [()] * 5


def test_ranges_use_scale_bias_and_variance():
    """Noise-free ranges of a calibrated radio above the target; the told variance counts, the default elsewhere."""
    anchors = make_anchors(
        [1, 2, 3, 4], [[0, 0, 2], [9, 0, 2], [9, 7, 2], [0, 7, 2.5]], scale=1.1, bias=[0.1, 0.2, 0.3, -0.1]
    )
    place = np.array([4.0, 3.0, 0.5])
    z = 1.1 * np.linalg.norm(anchors.positions - place, axis=1) + anchors.bias
    config = LossTolerantConfig(target_height=0.5, start=replace(GIVEN, mean=(4.4, 2.5, 0.0, 0.0)))

    def after(variance):
        packets = tuple(Range(0, i + 1, 1, 0, 0, Modality.UWB, float(r), variance) for i, r in enumerate(z))
        return tracked(config, [Epoch(1, k, 0, packets) for k in range(8)], anchors)[0][-1]

    assert after(1e-4).mean[:2] == pytest.approx(place[:2], abs=0.03)
    assert after(math.nan).covariance[0, 0] == pytest.approx(after(0.1**2).covariance[0, 0])
    assert after(0.3**2).covariance[0, 0] > 4.0 * after(0.1**2).covariance[0, 0]
