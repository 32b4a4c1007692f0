"""What a body does to a radio is found from a walk: both lines, or one constant, within their intervals."""

import math

import numpy as np
import pytest
from worn_cases import ANCHORS, KNOWN, SECOND, measured, walked

from wsn_tracking.bags.messages import UNKNOWN, truth_of
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE, mean_rssi
from wsn_tracking.sensing.body_fit import LEAST_READINGS, Worn, behind_body, facing, fit_body, fit_worn
from wsn_tracking.sensing.survey import Readings
from wsn_tracking.simulation.c_body import BodyConfig


def test_both_lines_are_found_beside_known_radios():
    """LOS and NLOS of the document at 3 to 30 m: 2300 readings of 3 dB, some 1 dB at either end of their distances."""
    body = fit_worn(*measured(walked()), ANCHORS, KNOWN).body
    for line, curve in ((body.los, LOS), (body.nlos, NLOS)):
        d = np.array([3.0, 10.0, 30.0])
        told = mean_rssi(SINGLE, d) + line.value[0] + line.value[1] * np.log10(d)
        np.testing.assert_allclose(told, mean_rssi(curve, d), atol=1.0)
        meant = np.array([curve.p_ref - SINGLE.p_ref, curve.k - SINGLE.k])
        assert np.all(np.abs(line.value - meant) < 4.0 * line.std)
    assert body.sigma_db == pytest.approx(3.0, abs=0.2)
    assert min(body.readings) > 800


def test_radios_that_nobody_knows_are_found_beside_the_body():
    """Path loss is the line in the middle, so that both sides lie as far from it: the document's by 4.0 and 3.6 dB."""
    config = BodyConfig(columns=2, rows=2, width=40.0, depth=40.0, duration=60.0, period=1.0, longest_pause=0.0)
    recording = walked(config)
    channel = fit_worn(*measured(recording), recording.anchors)
    d = np.array([10.0, 20.0])
    own = channel.path_loss.p1_dbm.value[:, None] - 10.0 * channel.path_loss.n.value[:, None] * np.log10(d)
    middle = 0.5 * (mean_rssi(LOS, d) + mean_rssi(NLOS, d))
    np.testing.assert_allclose(own, np.broadcast_to(middle, own.shape), atol=2.0)
    apart = channel.body.los.value - channel.body.nlos.value
    half = 0.5 * (apart[0] + apart[1] * np.log10(d))
    np.testing.assert_allclose(half, 0.5 * (mean_rssi(LOS, d) - mean_rssi(NLOS, d)), atol=0.7)


def test_wild_readings_do_not_move_the_lines():
    clean, wild = (fit_worn(*measured(walked(BodyConfig(outliers=share))), ANCHORS, KNOWN).body for share in (0.0, 0.1))
    for a, b in ((clean.los, wild.los), (clean.nlos, wild.nlos)):
        at_10_m = [line.value[0] + line.value[1] for line in (a, b)]
        assert at_10_m[0] == pytest.approx(at_10_m[1], abs=1.0)


def test_a_constant_is_found_where_nobody_knows_where_the_body_faces():
    readings, _ = measured(walked(BodyConfig(duration=60.0)))
    unknown = np.full(len(readings.values), math.nan)
    before, after = (
        fit_worn(readings._replace(values=readings.values + by), unknown, ANCHORS, KNOWN).body for by in (0.0, -6.5)
    )
    assert before.los is before.nlos is None
    assert after.loss.value[0] - before.loss.value[0] == pytest.approx(-6.5)
    assert after.loss.low[0] < after.loss.value[0] < after.loss.high[0]


def test_intervals_are_those_of_the_scatter_between_walks():
    """Of 20 walks at least four fifths have the true line at 10 m within their 95 % interval for the level."""
    rng = np.random.default_rng(1)
    inside = 0
    for _ in range(20):
        lg_d = rng.uniform(0.5, 1.5, 200)
        behind = rng.integers(0, 2, 200).astype(float)
        away = np.where(behind == 1.0, -4.0, 4.0) + 3.0 * rng.standard_normal(200)
        body = fit_body(Worn(lg_d - 1.0, away, behind))
        inside += bool(body.los.low[0] <= 4.0 <= body.los.high[0])
    assert inside >= 16


def test_too_few_readings_are_refused():
    worn = Worn(*np.zeros((3, LEAST_READINGS - 1)))
    with pytest.raises(TrackingError, match='at least 20'):
        fit_body(worn)


def test_strangers_among_the_nodes_are_left_out_and_a_ranging_channel_is_refused():
    readings, way = measured(walked(BodyConfig(duration=60.0)))
    more = Readings(
        np.vstack([readings.positions, readings.positions[:5]]),
        np.append(readings.node_ids, [99] * 5),
        np.append(readings.values, [0.0] * 5),
    )
    one, other = (fit_worn(r, w, ANCHORS, KNOWN).body for r, w in ((readings, way), (more, np.append(way, way[:5]))))
    np.testing.assert_array_equal(one.los.value, other.los.value)
    with pytest.raises(TrackingError, match='path loss'):
        fit_worn(readings, way, ANCHORS, KNOWN._replace(path_loss=None))


# ---- where he faces


def test_who_stands_faces_where_he_walked_and_what_is_told_comes_first():
    stamps = SECOND * np.arange(6)
    velocities = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.0, 0.0], [-1.0, 0.0], [math.nan, math.nan]])
    positions = np.zeros((6, 2))
    positions[:, 1] = [0, 0, 0, 1, 1, 3]
    way = facing(stamps, positions, velocities, None)
    np.testing.assert_allclose(way, [math.nan, math.nan, math.pi / 2, math.pi / 2, math.pi, math.pi / 2])
    told = facing(stamps, positions, velocities, np.array([0.3, math.nan, 0.3, math.nan, 0.3, math.nan]))
    np.testing.assert_allclose(told, [0.3, math.nan, 0.3, math.pi / 2, 0.3, math.pi / 2])


def test_a_node_ahead_is_in_front_and_one_abeam_behind():
    anchors = make_anchors([1, 2, 3], [[5.0, 0.0], [-5.0, 0.0], [0.0, 5.0]])
    readings = Readings(np.zeros((4, 3)), np.array([1, 2, 3, 1]), np.zeros(4))
    behind = behind_body(anchors, readings, np.array([0.0, 0.0, 0.0, math.nan]))
    np.testing.assert_array_equal(behind, [0.0, 1.0, 1.0, math.nan])


@pytest.mark.parametrize(('variance', 'told'), [(0.1, True), (UNKNOWN, False)])
def test_a_bag_tells_headings_by_its_truths_orientation(variance, told):
    yaw = np.array([0.5, -2.0])
    covariance = np.zeros((2, 36))
    covariance[:, -1] = variance
    columns = {f'pose.pose.position.{axis}': np.zeros(2) for axis in 'xyz'}
    columns |= {f'twist.twist.linear.{axis}': np.zeros(2) for axis in 'xyz'}
    columns |= {f'pose.pose.orientation.{axis}': np.zeros(2) for axis in 'xy'}
    columns |= {'pose.pose.orientation.z': np.sin(yaw / 2), 'pose.pose.orientation.w': np.cos(yaw / 2)}
    columns |= {'pose.covariance': covariance, 'twist.covariance': np.zeros((2, 36))}
    columns |= {'header.stamp.sec': np.array([1, 2]), 'header.stamp.nanosec': np.zeros(2, int)}
    truth, _ = truth_of(1, columns)
    if told:
        np.testing.assert_allclose(truth.headings, yaw)
    else:
        assert truth.headings is None
    columns['pose.pose.orientation.z'], columns['pose.pose.orientation.w'] = np.zeros(2), np.ones(2)
    assert truth_of(1, {**columns, 'pose.covariance': np.zeros((2, 36))})[0].headings is None
