"""Places of single epochs."""

import numpy as np
import pytest

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.reproduction.cross_baselines import Fix, Nearest
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi

PLACES = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [4.0, 4.0]])
ANCHORS = make_anchors([1, 2, 3, 4], PLACES)
TRUTH = np.array([1.0, 1.5])
D = np.hypot(*(PLACES - TRUTH).T)


def epoch(packets, k=0):
    return Epoch(1, k, 0, tuple(packets))


def ranges(d, nodes=(1, 2, 3, 4)):
    return [Range(0, n, 1, 0, 0, int(Modality.UWB), float(d[n - 1])) for n in nodes]


def place(tracker, packets):
    (estimate,) = tracker.step(epoch(packets))
    assert np.all(np.isnan(estimate.covariance))
    return estimate.mean[:2]


def test_exact_ranges_give_the_exact_place():
    assert place(Fix(ANCHORS), ranges(D)) == pytest.approx(TRUTH)


def test_exact_signal_strengths_give_the_exact_place():
    loud = [Rssi(0, n, 1, 0, 0, float(y)) for n, y in zip((1, 2, 3, 4), rssi_at(ANCHORS, D), strict=True)]
    assert place(Fix(ANCHORS), loud) == pytest.approx(TRUTH)
    assert np.array_equal(place(Nearest(ANCHORS), loud), PLACES[0])


def test_heights_are_taken_off():
    high = make_anchors([1, 2, 3, 4], np.column_stack([PLACES, np.full(4, 2.0)]))
    assert place(Fix(high, 0.5), ranges(np.hypot(D, 1.5))) == pytest.approx(TRUTH)


@pytest.mark.parametrize('kind', [Fix, Nearest])
def test_a_target_that_is_not_heard_stays_where_it_was(kind):
    tracker = kind(ANCHORS)
    assert np.array_equal(place(tracker, []), [2.0, 2.0])
    there = place(tracker, ranges(D))
    assert np.array_equal(place(tracker, []), there)
    tracker.reset()
    assert np.array_equal(place(tracker, []), [2.0, 2.0])
    assert tracker.state() == {}


def test_two_ranges_are_no_fix():
    tracker = Fix(ANCHORS)
    there = place(tracker, ranges(D))
    assert np.array_equal(place(tracker, ranges(D + 1.0, (1, 2))), there)
