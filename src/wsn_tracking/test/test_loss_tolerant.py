"""The tracker of system E, epoch by epoch: what is lost, what is wrong, and how it starts."""

import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.bags.estimates import differences
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.loss_tolerant import LossTolerantTracker
from wsn_tracking.trackers.loss_tolerant_config import (
    GateConfig,
    LossTolerantConfig,
    RestartConfig,
    TurnConfig,
    TurningStartConfig,
)

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
    tracker = LossTolerantTracker(config, anchors)
    return [tracker.step(epoch)[0] for epoch in given], tracker


def errors(estimates, truth):
    return np.array([np.hypot(*(e.mean[:2] - x[:2])) for e, x in zip(estimates, truth, strict=True)])


def is_usable(estimate):
    P = estimate.covariance
    return bool(np.all(np.isfinite(estimate.mean)) and np.all(np.isfinite(P)) and np.linalg.eigvalsh(P)[0] > 0.0)


EPOCHS, TRUTH = epochs()


# ---- what it gives


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


# ---- what is lost


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
    rmse = []
    for loss in (0.0, 0.5, 0.9):
        runs = [epochs(loss, seed) for seed in range(1, 6)]
        found = [errors(tracked(LossTolerantConfig(), given)[0], truth)[5:] for given, truth in runs]
        rmse.append(np.sqrt(np.mean(np.square(found))))
    assert all(a < b for a, b in pairwise(rmse))
    assert rmse[2] < 25.0


def test_a_held_value_is_used_again_and_not_listed():
    """Node 1 is heard once: it pulls the track again and again, where it should be forgotten."""
    first = EPOCHS[0]
    rest = [e._replace(measurements=()) for e in EPOCHS[1:6]]
    held, _ = tracked(LossTolerantConfig(filter='hold', start=GIVEN), [first, *rest])
    fair, _ = tracked(LossTolerantConfig(start=GIVEN), [first, *rest])
    np.testing.assert_array_equal(held[0].mean, fair[0].mean)
    assert np.trace(held[-1].covariance[:2, :2]) < 0.5 * np.trace(fair[-1].covariance[:2, :2])
    assert [e.measurements for e in held[1:]] == [()] * 5


# ---- what is wrong


NAN, INF = math.nan, math.inf
WRONG = [
    Rssi(0, 1, 1, 9, 9, NAN),
    Rssi(0, 1, 1, 9, 9, INF),
    Rssi(0, 1, 1, 9, 9, 127.0),
    Rssi(0, 1, 1, 9, 9, -50.0, 0.0),
    Rssi(0, 1, 1, 9, 9, -50.0, -2.0),
    Rssi(0, 1, 1, 9, 9, -50.0, 1e-200),
    Range(0, 1, 1, 9, 9, Modality.UWB, NAN),
    Range(0, 1, 1, 9, 9, Modality.UWB, -3.0),
    Range(0, 1, 1, 9, 9, Modality.UWB, 0.0),
    Range(0, 1, 1, 9, 9, Modality.UWB, 1e9),
    Range(0, 1, 1, 9, 9, Modality.UWB, 5.0, -1.0),
    Range(0, 1, 1, 9, 9, Modality.UWB, 5.0, 1e-100),
]


@pytest.mark.parametrize('packet', WRONG, ids=str)
def test_an_impossible_value_is_dropped_and_counted(packet):
    rest = tuple(p for p in EPOCHS[9].measurements if p.node_id != 1)
    bad = EPOCHS[9]._replace(measurements=(packet, *rest))
    one, tracker = tracked(LossTolerantConfig(), [*EPOCHS[:9], bad])
    other, _ = tracked(LossTolerantConfig(), [*EPOCHS[:9], bad._replace(measurements=rest)])
    assert differences(one, other) == []
    assert tracker.counters == {'invalid': 1}


def test_an_unknown_node_is_dropped_and_counted():
    stranger = EPOCHS[9].measurements[0]._replace(node_id=4711)
    more = EPOCHS[9]._replace(measurements=(*EPOCHS[9].measurements, stranger))
    one, tracker = tracked(LossTolerantConfig(), [*EPOCHS[:9], more])
    assert differences(one, tracked(LossTolerantConfig(), EPOCHS[:10])[0]) == []
    assert tracker.counters == {'unknown_node': 1}


def test_a_bearing_beside_a_range_is_left_aside():
    """And one that did not arrive is lost, not wrong; nor is a bearing alone."""
    place = np.array([30.0, 40.0])
    d = np.hypot(*(place - ANCHORS.positions[:, :2]).T).tolist()
    ranges = [Range(0, i + 1, 1, 0, 0, Modality.OTHER, r, 0.04) for i, r in enumerate(d)]
    seen = [RangeBearing(0, i + 1, 1, 0, 0, r, 0.3, (0.04, 0.0, 0.0, 1.0)) for i, r in enumerate(d)]
    lost = seen[3]._replace(arrived=False, range=NAN, bearing=NAN)
    alone = seen[4]._replace(range=NAN)
    one, _ = tracked(LossTolerantConfig(), [Epoch(1, 0, 0, (*ranges[:3], *ranges[5:]))])
    other, tracker = tracked(LossTolerantConfig(), [Epoch(1, 0, 0, (*seen[:3], lost, alone, *seen[5:]))])
    assert differences(one, other) == []
    assert not tracker.counters
    assert other[0].mean[:2] == pytest.approx(place, abs=0.5)


def test_an_outlier_is_gated_and_not_listed():
    wrong = EPOCHS[30].measurements[0]
    outlier = wrong._replace(rssi_dbm=wrong.rssi_dbm + 60.0)
    bad = EPOCHS[30]._replace(measurements=(outlier, *EPOCHS[30].measurements[1:]))
    estimates, tracker = tracked(LossTolerantConfig(robust=GateConfig(4.0)), [*EPOCHS[:30], bad])
    assert tracker.counters == {'gated': 1}
    assert estimates[-1].measurements == tuple(p.node_id for p in EPOCHS[30].measurements[1:])
    assert errors(estimates, TRUTH[:31])[-1] < 12.0


def test_a_track_whose_readings_are_gated_is_found_anew():
    """Clear radios, and a start at the other end of the field that is all too sure."""
    precise = e_loss(LossConfig(loss=0.3, sigma_db=0.5))
    given = list(epochs_of(record(precise, 1), 1, Counter()))
    start = replace(GIVEN, mean=(90.0, 90.0, 0.0, 0.0), std=(0.1, 0.1, 0.1, 0.1))
    config = LossTolerantConfig(robust=GateConfig(4.0), reacquire=RestartConfig(rejects=3), start=start)
    estimates, tracker = tracked(config, given, precise.anchors)
    assert tracker.counters['reacquired_after_rejects'] == 1
    assert np.sqrt(np.mean(errors(estimates, precise.truth)[10:] ** 2)) < 3.0
    never, _ = tracked(replace(config, reacquire=RestartConfig(rejects=0)), given[:10], precise.anchors)
    assert errors(never, precise.truth[:10])[-1] > 30.0


def test_a_filter_that_runs_away_is_caught():
    """Started at a speed, or a place, that nothing here can have."""
    lost = replace(GIVEN, mean=(21.0, 24.0, 60.0, 0.0))
    estimates, tracker = tracked(LossTolerantConfig(start=lost), EPOCHS)
    assert tracker.counters == {'reacquired_after_divergence': 1}
    assert np.sqrt(np.mean(errors(estimates, TRUTH)[10:] ** 2)) < 12.0
    far = replace(GIVEN, mean=(500.0, 24.0, 0.0, 0.0), std=(0.1, 0.1, 0.1, 0.1))
    assert tracked(LossTolerantConfig(start=far), EPOCHS[:2])[1].counters == {'reacquired_after_divergence': 1}


# ---- time


@pytest.mark.parametrize('name', FILTERS)
@pytest.mark.parametrize('gap', [0, -5, -3600, 1, 40, 3600, 10**6])
def test_any_step_in_time_is_bounded_and_finite(name, gap):
    """Seconds between epochs 49 and 50; what comes after keeps its distances."""
    moved = [e._replace(stamp_ns=e.stamp_ns + (gap - 1) * SECOND * (k >= 50)) for k, e in enumerate(EPOCHS)]
    estimates, tracker = tracked(LossTolerantConfig(filter=name, area=WORLD.area), moved)
    assert all(is_usable(e) for e in estimates)
    low, high = WORLD.area[:2], WORLD.area[2:]
    assert all(np.all((e.mean[:2] >= low) & (e.mean[:2] <= high)) for e in estimates)
    assert tracker.counters['stamp_fell'] == (gap < 0)
    assert tracker.counters['reacquired_after_silence'] == (gap > 30)
    settled = errors(estimates, TRUTH)[70:]
    assert np.sqrt(np.mean(settled**2)) < (25.0 if name in ('hold', 'ekf') else 12.0)


@pytest.mark.parametrize('area', [(), WORLD.area])
def test_an_hour_of_silence_ends_in_a_standstill_and_a_new_start(area):
    silent = [Epoch(1, 50 + k, EPOCHS[49].stamp_ns + (k + 1) * SECOND, ()) for k in range(3600)]
    later = [e._replace(stamp_ns=e.stamp_ns + 3600 * SECOND) for e in EPOCHS[50:]]
    config = LossTolerantConfig(area=area)
    estimates, tracker = tracked(config, [*EPOCHS[:50], *silent[::30], *later])
    quiet = estimates[50 : 50 + len(silent[::30])]
    assert all(is_usable(e) for e in quiet)
    np.testing.assert_array_equal(quiet[-1].mean, quiet[2].mean)
    np.testing.assert_array_equal(quiet[-1].covariance, quiet[2].covariance)
    assert 15.0 < np.sqrt(quiet[-1].covariance[0, 0]) < 200.0
    assert tracker.counters == {'reacquired_after_silence': 1}
    assert np.sqrt(np.mean(errors(estimates[-40:], TRUTH[60:]) ** 2)) < 12.0


def test_without_a_new_start_a_gap_is_bridged_as_far_as_the_horizon():
    config = LossTolerantConfig(turn=TurnConfig(horizon=5.0), reacquire=RestartConfig(silence=0.0))
    late = EPOCHS[50]._replace(stamp_ns=EPOCHS[49].stamp_ns + 3600 * SECOND)
    soon = EPOCHS[50]._replace(stamp_ns=EPOCHS[49].stamp_ns + 5 * SECOND)
    one, other = (tracked(config, [*EPOCHS[:50], e])[0] for e in (late, soon))
    np.testing.assert_array_equal(one[-1].mean, other[-1].mean)


@st.composite
def hostile(draw):
    """Epochs of any stamps and values."""
    numbers = st.floats(allow_nan=True, allow_infinity=True)
    given = []
    for seq in range(draw(st.integers(1, 12))):
        packets = [
            Rssi(0, draw(st.integers(0, 20)), 1, seq, seq, draw(st.floats(-130.0, 25.0) | numbers), draw(numbers))
            for _ in range(draw(st.integers(0, 6)))
        ]
        given.append(Epoch(1, seq, draw(st.integers(0, 2**62)), tuple(packets)))
    return given


@given(hostile(), st.sampled_from(FILTERS))
@settings(properties, max_examples=40)
def test_whatever_comes_the_estimate_stays_finite(given_, name):
    estimates, _ = tracked(LossTolerantConfig(filter=name, area=WORLD.area, start=GIVEN), given_)
    for e in estimates:
        assert np.all(np.isfinite(e.mean))
        assert np.all(np.isfinite(e.covariance))
        assert np.all(np.diag(e.covariance) > 0.0)


# ---- ranges


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
    assert after(NAN).covariance[0, 0] == pytest.approx(after(0.1**2).covariance[0, 0])
    assert after(0.3**2).covariance[0, 0] > 4.0 * after(0.1**2).covariance[0, 0]
