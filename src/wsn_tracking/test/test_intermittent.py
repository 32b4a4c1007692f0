"""Judging a track at regular instants, where ranges come in bursts."""

import numpy as np
import pytest

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.intermittent import Heard, at_instants, found_again, heard_of
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.recording import Recording, Truth
from wsn_tracking.sensing.values import Range, RangeBearing, Request
from wsn_tracking.trackers.estimate import Estimate, Kind

S = 1_000_000_000


def truth(seconds=20.0, velocity=0.5):
    t = np.arange(0.0, seconds + 0.05, 0.1)
    xyz = np.column_stack([velocity * t, np.ones(t.size), np.zeros(t.size)])
    return Truth(3, np.round(t * S).astype(np.int64), xyz, np.full(xyz.shape, np.nan))


def heard(*seconds_and_nodes):
    table = np.array([(round(t * S), node) for t, node in seconds_and_nodes], dtype=np.int64).reshape(-1, 2)
    return Heard(table[:, 0], table[:, 1])


def estimate(t, x, y, vx=0.0, vy=0.0, kind=Kind.LOCAL):
    return Estimate(round(t * S), 3, 0, 'one', np.array([x, y, vx, vy]), np.eye(4), kind=kind)


def test_only_instants_that_heard_something_lately_count():
    found = at_instants([estimate(0.0, 0.0, 1.0, 0.5)], truth(), heard((0.0, 1), (10.0, 1)))
    counted = found.stamps_ns[found.counts] / S
    np.testing.assert_allclose(counted, np.concatenate([np.arange(0, 21), np.arange(100, 121)]) / 10.0)


def test_an_estimate_is_moved_on_at_its_velocity_until_the_next():
    told = [estimate(0.0, 0.0, 1.0, 0.5), estimate(1.0, 0.5, 1.3)]
    found = at_instants(told, truth(), heard((0.0, 1), (1.0, 1)))
    np.testing.assert_allclose(found.errors_m[:10], 0.0, atol=1e-12)
    np.testing.assert_allclose(found.errors_m[10:13], np.hypot([0.0, 0.05, 0.1], 0.3))


def test_who_says_nothing_or_has_only_begun_is_judged_all_the_same():
    late = at_instants([estimate(1.5, 0.75, 1.0, 0.5)], truth(), heard((0.0, 1)))
    assert late.counts.sum() == 21
    assert np.isinf(late.errors_m[:15]).all()
    assert late.median_m == np.inf
    flat = at_instants([estimate(0.0, 5.0, 1.0, kind=Kind.START)], truth(), heard((0.0, 1)))
    assert flat.median_m == pytest.approx(4.5)
    none = at_instants([], truth(), heard((0.0, 1)))
    assert none.median_m == np.inf


def test_instants_without_truth_do_not_count():
    late = truth()._replace(stamps_ns=truth().stamps_ns + S)
    found = at_instants([estimate(0.0, 0.0, 1.0)], late, heard((0.0, 1)))
    assert found.stamps_ns[found.counts].tolist() == [S + k * S // 10 for k in range(11)]
    assert np.isnan(found.errors_m[:10]).all()
    nowhere = at_instants([estimate(0.0, 0.0, 1.0)], late._replace(stamps_ns=late.stamps_ns + 50 * S), heard((0.0, 1)))
    assert np.isnan(nowhere.median_m)
    with pytest.raises(TrackingError, match='there is no truth of target 3'):
        at_instants([], truth()._replace(stamps_ns=np.array([], dtype=np.int64)), heard((0.0, 1)))
    with pytest.raises(TrackingError, match='there is no measurement of target 3'):
        at_instants([], truth(), heard())


def test_a_target_can_be_found_when_three_nodes_were_heard_within_eight_seconds_since_a_silence():
    three = heard((0, 1), (1, 2), (2, 2), (3, 3), (4, 4), (9, 1), (10, 2), (11, 3), (14, 1), (15, 2), (17.5, 3))
    instants = at_instants([estimate(0.0, 0.0, 1.0, 0.5)], truth(), three)
    assert found_again(instants, three).stamps_ns.tolist() == [3 * S, 11 * S]
    assert found_again(instants, three, silence_s=100.0).stamps_ns.tolist() == [3 * S]
    slow = heard((0, 1), (4, 2), (9, 3), (11, 1))
    assert found_again(instants, slow, silence_s=100.0).stamps_ns.tolist() == [11 * S]


def test_the_error_after_a_delay_is_that_of_the_last_instant_that_counts():
    bursts = heard((0, 1), (0, 2), (0, 3), (10, 1), (10, 2), (10, 3))
    told = [estimate(0, 1.0, 1.0, 0.5), estimate(1, 0.5, 1.2, 0.5), estimate(10, 8.0, 1.0, 0.5)]
    found = found_again(at_instants(told, truth(), bursts), bursts)
    assert found.stamps_ns.tolist() == [0, 10 * S]
    assert found.errors_m.shape == (2, 101)
    assert found.median_after(0.0) == pytest.approx(2.0)
    assert found.median_after(9.9) == pytest.approx((0.2 + 3.0) / 2.0)
    assert np.isnan(found_again(at_instants(told, truth(), bursts), heard((0, 1))).median_after(10.0))


def test_what_was_heard_are_usable_measurements_by_nodes_whose_place_is_known():
    messages = (
        Request(0, 3, 0),
        Range(5, 1, 3, 0, 0, 4, 2.0),
        Range(4, 2, 3, 0, 0, 4, 2.0),
        Range(6, 9, 3, 0, 0, 4, 2.0),
        Range(6, 1, 4, 0, 0, 4, 2.0),
        Range(7, 1, 3, 0, 0, 4, -2.0),
        RangeBearing(8, 1, 3, 0, 0, 2.0, 0.0, (1.0, 0.0, 0.0, 1.0), arrived=False),
        RangeBearing(9, 1, 3, 0, 0, 2.0, 0.0, (1.0, 0.0, 0.0, 1.0)),
    )
    recording = Recording(make_anchors([1, 2], [[0, 0], [1, 1]]), 'range', messages, {}, {}, {})
    found = heard_of(recording, 3)
    assert (found.stamps_ns.tolist(), found.nodes.tolist()) == ([4, 5, 9], [2, 1, 1])
