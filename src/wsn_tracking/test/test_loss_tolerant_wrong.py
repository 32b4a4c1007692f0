"""What is wrong, impossible or foreign among the readings of system E is dropped and counted; a lost track is found."""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from loss_cases import ANCHORS, EPOCHS, FILTERS, GIVEN, SECOND, TRUTH, WORLD, errors, tracked
from oracles import properties

from wsn_tracking.bags.estimates import differences
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.simulation.e_loss import LossConfig, e_loss
from wsn_tracking.simulation.record import record
from wsn_tracking.trackers.loss_tolerant_config import GateConfig, LossTolerantConfig, RestartConfig

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


@pytest.mark.parametrize('name', FILTERS)
def test_a_node_that_stands_alone_leaves_the_covariance_bounded(name):
    """By its readings the target may be anywhere on a ring: it is never less known than within the area's side."""
    alone = make_anchors([1], [[50.0, 50.0]])
    area = (0.0, 0.0, 100.0, 100.0)
    given = [Epoch(1, k, k * SECOND, (Rssi(k * SECOND, 1, 1, k, k, -82.0),)) for k in range(120)]
    estimates, _ = tracked(LossTolerantConfig(filter=name, area=area), given, alone)
    for e in estimates:
        assert np.all(np.isfinite(e.mean))
        assert math.sqrt(np.trace(e.covariance[:2, :2])) <= 100.0 * (1.0 + 1e-9)


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
