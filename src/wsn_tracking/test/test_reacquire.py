"""A track that is lost, silent or in the wrong place is found anew, and no other."""

import numpy as np
import pytest
from oracles import LOOP, H
from robust_cases import epoch, estimator, ranges

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.random_q import LocalEstimator
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, ReacquireConfig, RobustConfig, StartConfig


def test_a_lost_track_is_found_anew():
    """The target is carried off: most ranges are rejected until the filter starts again where it is now."""
    rng = np.random.default_rng(5)
    lost = estimator(robust=RobustConfig(gate=4.0), reacquire=ReacquireConfig(rejects=3, window=2.0))
    stuck = estimator(robust=RobustConfig(gate=4.0))
    kinds = []
    for k in range(20):
        at = k if k < 10 else k + 40  # the opposite side of the loop
        found, kept = (e.step(epoch(k, ranges(at, rng))) for e in (lost, stuck))
        kinds.append(found.kind)
    assert kinds.count(Kind.START) == 1
    assert lost.counters['reacquired_after_rejects'] == 1
    assert np.hypot(*(found.mean - LOOP.truth[59])[:2]) < 0.3  # three times the noise of a range
    assert np.hypot(*(kept.mean - LOOP.truth[59])[:2]) > 1.0  # on the other side of the loop


def test_after_a_long_silence_the_filter_starts_anew():
    rng = np.random.default_rng(6)
    track = estimator(reacquire=ReacquireConfig(silence=5.0))
    for k in range(3):
        assert track.step(epoch(k, ranges(k, rng))).kind == Kind.LOCAL
    for k in range(3, 12):
        assert track.step(epoch(k, np.full(12, np.nan))).kind == Kind.LOCAL
    back = track.step(epoch(12, ranges(60, rng)))
    assert back.kind == Kind.START
    assert np.hypot(*(back.mean - LOOP.truth[60])[:2]) < 0.3
    assert track.counters == {'reacquired_after_silence': 1}
    assert track.step(epoch(13, ranges(61, rng))).kind == Kind.LOCAL


@pytest.mark.parametrize('std', [0.1, 0.5])
def test_a_track_in_the_wrong_place_is_found_anew_and_no_other(std):
    """Set off in the wrong corner, sure of it, ranges taken for worse than they are: no gate would reject any."""
    rng = np.random.default_rng(10)
    wrong = StartConfig(kind='given', mean=(3.4, 2.2, 0.0, 0.0), std=(0.05, 0.05, 0.01, 0.01))
    odds = ReacquireConfig(odds=4.0, window=4.0)
    astray, right = estimator(start=wrong, reacquire=odds), estimator(reacquire=odds)
    for k in range(60):
        given = epoch(k, H(LOOP.truth[k]) + std * rng.standard_normal(12), variance=0.7**2)
        found, kept = astray.step(given), right.step(given)
        assert kept.kind == Kind.LOCAL
        assert (found.kind == Kind.START) == (k == 4)
        assert k < 4 or np.hypot(*(found.mean - LOOP.truth[k])[:2]) < 1.0
    assert astray.counters == {'reacquired_elsewhere': 1}
    assert right.counters == {}


def test_several_places_that_suit_equally_are_no_reason_to_leave_the_track():
    """Two nodes leave two places; their middle suits none."""
    anchors = make_anchors([1, 2], [[0.0, 0.0], [4.0, 0.0]])
    start = StartConfig(kind='given', mean=(2.0, 1.5, 0.0, 0.0), std=(0.1, 0.1, 0.01, 0.01))
    config = RandomQConfig(start=start, noise=NoiseConfig(kind='acceleration'), reacquire=ReacquireConfig(odds=0.5))
    track = LocalEstimator(config, anchors, 1)
    for k in range(20):
        heard = tuple(Range(k * 10**9, i, 1, k, k, Modality.UWB, 2.5, 0.01) for i in (1, 2))
        estimate = track.step(Epoch(1, k, k * 10**9, heard))
    np.testing.assert_allclose(estimate.mean[:2], [2.0, 1.5], atol=0.05)
    assert track.counters == {}
