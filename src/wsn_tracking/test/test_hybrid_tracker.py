"""One track a target: it starts, follows, predicts, and is repeatable."""

import random

import numpy as np
import pytest
from hybrid_cases import ANCHORS, LINE, ON_TRACK, S, epoch_of, errors, moved, recorded, tracked, walk_of

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.parameters import build
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig


def test_two_interleaved_targets_are_two_separate_runs_to_the_last_bit():
    separate, together = {}, {1: [], 2: []}
    own = {target: recorded('d_phase', target=target, lasts=6.0)[0] for target in (1, 2)}
    for target, epochs in own.items():
        separate[target] = tracked(epochs, target=target)[1]
    trackers = {target: HybridTracker(HybridConfig(), ANCHORS, target) for target in own}
    for pair in zip(own[1], own[2], strict=True):
        for epoch in pair:
            together[epoch.target_id] += trackers[epoch.target_id].step(epoch)
    assert differences(separate[1], together[1]) == []
    assert differences(separate[2], together[2]) == []


def test_before_the_start_the_target_may_be_anywhere_in_the_area():
    tracker = HybridTracker(HybridConfig(area=(0.0, 0.0, 4.0, 6.0)), ANCHORS, 7)
    (first,) = tracker.step(epoch_of(0, [], target=7))
    assert (first.kind, first.source, first.measurements) == (Kind.START, 'hybrid_target_7', ())
    assert tracker.outputs == ('hybrid_target_7',)
    np.testing.assert_allclose(first.mean, [2.0, 3.0, 0.0, 0.0])
    np.testing.assert_allclose(np.diag(first.covariance)[:2], [16.0 / 12.0, 36.0 / 12.0])
    assert tracker.state()['phase'] == 'starting'
    (ring,) = tracker.step(epoch_of(1, [(0, 3.0)], target=7))
    assert ring.kind == Kind.START
    assert ring.measurements == (1,)
    assert 0.5 < np.sqrt(ring.covariance[0, 0]) < 3.0


def test_a_track_starts_by_least_squares_and_is_consistent():
    truth_of, found, kinds = [], [], []
    for seed in range(6):
        epochs, truth = recorded('d_stop', seed, rest=0.5)
        tracker, estimates = tracked(epochs)
        assert tracker.counters['started'] == 1
        kinds.append([e.kind for e in estimates])
        truth_of.append(truth[40:])
        found.append(estimates[40:])
    assert {k for run in kinds for k in run[40:]} == {Kind.LOCAL}
    assert max(run.index(Kind.LOCAL) for run in kinds) <= 8
    e = np.array(
        [[est.mean[:2] - x for est, x in zip(*pair, strict=True)] for pair in zip(found, truth_of, strict=True)]
    )
    P = np.array([[est.covariance[:2, :2] for est in run] for run in found])
    assert 1.3 < np.mean(nees(e, P)) < 3.0  # 2; the design's q_w is about right for a straight walk
    for run in found:
        check_usable(run[-1])


@pytest.mark.parametrize('form', ['inflate', 'decay', 'imm', 'ekf'])
def test_every_form_tracks(form):
    epochs, truth = recorded('d_arc_stop', 3)
    tracker, estimates = tracked(epochs, HybridConfig(form=form))
    assert errors(estimates, truth)[40:].max() < ON_TRACK
    assert tracker.counters['gated'] == 0


def test_an_epoch_of_several_ranges_is_as_many_epochs_of_one_in_the_order_of_their_stamps():
    singles = walk_of(LINE)
    groups = []
    for k in range(0, 160, 4):
        packets = [p for e in singles[k : k + 4] for p in e.measurements]
        random.Random(k).shuffle(packets)
        groups.append(Epoch(1, k + 3, singles[k + 3].stamp_ns, tuple(packets)))
    _, one_by_one = tracked(singles)
    _, together = tracked(groups)
    for one, several in zip(one_by_one[3::4], together, strict=True):  # seconds are counted from the first epoch
        np.testing.assert_allclose(several.mean, one.mean, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(several.covariance, one.covariance, rtol=0.0, atol=1e-9)
        assert several.kind == one.kind
    assert together[5].measurements == tuple(sorted(together[5].measurements))


def test_an_empty_epoch_predicts():
    _, estimates = tracked([*walk_of(LINE), *(epoch_of(k, []) for k in range(160, 170))])
    before, after = estimates[159], estimates[169]
    F = np.eye(4) + 0.5 * np.eye(4, k=2)
    np.testing.assert_allclose(after.mean, F @ before.mean, atol=1e-9)
    assert after.covariance[0, 0] > before.covariance[0, 0]
    assert after.measurements == ()
    assert after.kind == Kind.LOCAL


def test_an_estimate_is_of_the_stamp_of_its_epoch_even_where_ranges_came_later():
    epochs = walk_of(LINE, noise=0.0)
    late = [e._replace(stamp_ns=e.stamp_ns - 30_000_000) for e in epochs]
    _, estimates = tracked(late)
    x = np.array([e.mean[0] for e in estimates[80:]])
    np.testing.assert_allclose(x, LINE[80:, 0] - 0.2 * 0.03, atol=0.004)


def test_a_reset_tracker_is_a_new_one():
    epochs, _ = recorded('d_stop', 5, rest=0.5)
    tracker, first = tracked(epochs)
    tracker.reset()
    assert differences(first, [tracker.step(epoch)[0] for epoch in epochs]) == []


def test_the_same_ranges_an_hour_later_are_the_same_track():
    epochs = walk_of(LINE)
    first, second = tracked(epochs)[1], tracked([moved(e, e.stamp_ns + 3600 * S) for e in epochs])[1]
    assert differences(first, [e._replace(stamp_ns=e.stamp_ns - 3600 * S) for e in second]) == []


@pytest.mark.parametrize(
    ('values', 'said'),
    [
        ({'form': 'magic'}, 'expected one of inflate, decay, literal, imm, ekf'),
        ({'motion.spectral_density': 0.0}, 'without process noise a filter stops listening'),
        ({'form': 'imm', 'models.calm': 50.0}, 'expected 0 < calm < brisk'),
        ({'area': [1.0, 2.0, 3.0]}, 'area'),
    ],
)
def test_parameters_that_contradict_each_other_are_refused(values, said):
    with pytest.raises(TrackingError, match=said):
        build(HybridConfig, values).checked()
