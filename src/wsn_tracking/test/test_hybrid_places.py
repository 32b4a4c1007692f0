"""Where least squares is not possible: two nodes, or single ranges at long intervals."""

import numpy as np
import pytest
from hybrid_cases import ON_TRACK, RESTING, S, errors, moved, tracked, walk_of

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, StartConfig


def test_a_target_that_two_nodes_hear_is_one_of_two_places():
    """The other side of the line through the nodes lies outside the area, or else both are told."""
    two = make_anchors([1, 2], [[0.0, 0.0], [4.0, 0.0]])
    places = np.column_stack([1.0 + 0.002 * np.arange(200), np.full(200, 1.5)])
    half, both = (0.0, 0.0, 4.0, 3.0), (0.0, -3.0, 4.0, 3.0)
    epochs = walk_of(places, anchors=two)
    tracker, estimates = tracked(epochs, HybridConfig(area=half), two)
    assert tracker.counters['started'] == 1
    assert errors(estimates, places)[60:].max() < ON_TRACK
    torn, estimates = tracked(epochs, HybridConfig(area=both), two)
    assert {e.kind for e in estimates} == {Kind.START}
    assert torn.state()['hypotheses'] == 2
    assert estimates[-1].mean[1] == pytest.approx(0.0, abs=1e-9)  # halfway between both
    assert np.sqrt(estimates[-1].covariance[1, 1]) == pytest.approx(1.5, rel=0.2)


def test_hypotheses_alone_find_a_target_from_single_ranges_at_long_intervals():
    slow = [moved(e, k * S) for k, e in enumerate(walk_of(RESTING[:40], noise=0.05))]
    config = HybridConfig(
        range_std=0.1,
        stale=5.0,
        motion=MotionConfig(1e-4, 20.0),
        start=StartConfig(kind='hypotheses', velocity_std=0.05),
    )
    tracker, estimates = tracked(slow, config)
    assert tracker.counters['started'] == 1
    assert errors(estimates, [1.3, 2.6])[15:].max() < 0.2  # four times the noise of these ranges
    # silent, then somewhere near: what was known before is not forgotten
    back = [tracker.step(moved(e, e.stamp_ns + 80 * S))[0] for e in slow]
    assert tracker.counters['stale'] == tracker.counters['reacquired'] == 1
    assert errors(back, [1.3, 2.6])[15:].max() < 0.2
