"""calibrate --body: both lines of a body, or one constant, from a walk; the file that holds them; who uses it."""

import math

import numpy as np
import pytest

from wsn_tracking.bags.messages import UNKNOWN, truth_of
from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE, mean_rssi
from wsn_tracking.sensing.body_fit import LEAST_READINGS, Worn, behind_body, facing, fit_body, fit_worn
from wsn_tracking.sensing.channel import Body, Channel, PathLoss, Quantity, body_of, load_channel, save_channel
from wsn_tracking.sensing.survey import Readings
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.c_body import BodyConfig, body_scenario, nodes
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.surveys import open_walk
from wsn_tracking.trackers.human_config import HumanConfig, SignalConfig
from wsn_tracking.trackers.human_models import curves_of

ANCHORS = nodes(BodyConfig())
SECOND = 1_000_000_000


def exact(value):
    return Quantity(*(np.full(16, v) for v in (value, 0.1, value - 0.2, value + 0.2)))


KNOWN = Channel(
    ANCHORS.ids,
    PathLoss(exact(SINGLE.p_ref), exact(-SINGLE.k / 10.0), exact(3.0), np.ones(16, int), np.ones(16, int)),
    None,
    None,
    {'survey': 'of a test'},
)


def walked(config=None, seed=1):
    return record(body_scenario('c_walk', config or BodyConfig(), seed), seed)


def measured(recording):
    """Readings and headings of a recording whose epochs have the truth's stamps."""
    truth = recording.truth[1]
    heard = [m for m in recording.messages if isinstance(m, Rssi)]
    at = np.searchsorted(truth.stamps_ns, [m.stamp_ns for m in heard])
    way = facing(truth.stamps_ns, truth.positions, truth.velocities, truth.headings)
    ids, values = np.array([m.node_id for m in heard]), np.array([m.rssi_dbm for m in heard])
    return Readings(truth.positions[at], ids, values), way[at]


# --- the fit


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


# --- where the body faces


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


# --- file, command and tracker


def of(line):
    return None if line is None else Quantity(*(np.array([v, v / 2]) for v in (line, 0.5, line - 1.0, line + 1.0)))


@pytest.mark.parametrize('sides', [True, False])
def test_a_body_survives_its_file(tmp_path, sides):
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    body = Body(loss, of(4.0) if sides else None, of(-4.0) if sides else None, 3.25, (100, 200 if sides else 0))
    save_channel(tmp_path / 'c.yaml', KNOWN._replace(body=body))
    back = body_of(str(tmp_path / 'c.yaml'))
    np.testing.assert_allclose(back.loss.value, [-6.5])
    assert (back.sigma_db, back.readings) == (3.25, body.readings)
    assert (back.los is None) is not sides
    if sides:
        np.testing.assert_allclose(back.los.value, [4.0, 2.0])
        np.testing.assert_allclose(back.nlos.high, [-3.0, -1.5])
    save_channel(tmp_path / 'none.yaml', KNOWN)
    assert body_of(str(tmp_path / 'none.yaml')) is body_of('') is None


@pytest.mark.parametrize(
    ('old', 'new', 'words'),
    [
        ('loss: [-6.5', 'loss: [-99.0', '`loss` of `body`'),
        ('sigma_db: 3.25', 'sigma_db: 0.0', '`sigma_db` of `body`'),
        ('readings: [100, 200]', 'readings: [100]', '`readings` of `body`'),
        ('readings: [100, 200]', 'readings: [100, -1]', '`readings` of `body`'),
        ('per_decade: [2.0', 'per_octave: [2.0', '`los` of `body`'),
        ('  los:', '  left:', '`body` holds'),
        ('  loss:', '  lost:', '`body` holds'),
        ('path_loss:', 'path_los:', 'sections'),
    ],
)
def test_a_body_that_is_spoilt_is_refused_with_its_place(tmp_path, old, new, words):
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    path = tmp_path / 'c.yaml'
    save_channel(path, KNOWN._replace(body=Body(loss, of(4.0), of(-4.0), 3.25, (100, 200))))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(TrackingError, match=words):
        load_channel(path)


def test_the_command_makes_a_file_that_the_tracker_takes(call, tmp_path):
    save(tmp_path / 'bag', walked(BodyConfig(duration=100.0)))
    save_channel(tmp_path / 'radios.yaml', KNOWN)
    out = tmp_path / 'worn.yaml'
    ended = call('calibrate', tmp_path / 'bag', '--body', '--channel', tmp_path / 'radios.yaml', '-o', out)
    assert ended.code == 0
    assert 'per decade' in ended.out
    channel = load_channel(out)
    assert channel.origin['survey'] == 'of a test'
    assert channel.origin['body_bag'] == 'bag'
    body = fit_worn(*measured(read(tmp_path / 'bag')), ANCHORS, KNOWN).body
    np.testing.assert_allclose(channel.body.los.value, body.los.value, rtol=1e-5)
    curves = curves_of(HumanConfig(), ANCHORS, channel.body)
    np.testing.assert_allclose(curves.los.p_ref, SINGLE.p_ref + body.los.value[0], rtol=1e-5)
    np.testing.assert_allclose(curves.nlos.k, SINGLE.k + body.nlos.value[1], rtol=1e-5)
    np.testing.assert_allclose(curves.single.p_ref, SINGLE.p_ref + body.loss.value[0], rtol=1e-5)
    given_ = curves_of(HumanConfig(signal=SignalConfig(curves='given')), ANCHORS, channel.body)
    np.testing.assert_array_equal(given_.los.p_ref, np.full(16, LOS.p_ref))


def test_a_constant_loss_shifts_every_curve():
    loss = Quantity(*(np.array([v]) for v in (-6.5, 0.5, -7.5, -5.5)))
    plain = curves_of(HumanConfig(), ANCHORS)
    worn = curves_of(HumanConfig(), ANCHORS, Body(loss, None, None, 3.0, (100, 0)))
    for before, after in zip(plain, worn, strict=True):
        np.testing.assert_allclose(after.p_ref, before.p_ref - 6.5)
        np.testing.assert_array_equal(after.k, before.k)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['--body', '--map'], '--map is of a survey'),
        (['--channel', 'x.yaml'], 'without --body'),
    ],
)
def test_options_that_make_no_sense_together_are_refused(call, tmp_path, arguments, words):
    save(tmp_path / 'bag', walked(BodyConfig(duration=10.0)))
    ended = call('calibrate', tmp_path / 'bag', *arguments, '-o', tmp_path / 'out.yaml')
    assert ended.code != 0
    assert words in ended.err
    assert not (tmp_path / 'out.yaml').exists()


def test_a_body_is_of_a_walk_and_of_signal_strengths(tmp_path):
    (tmp_path / 'survey').mkdir()
    (tmp_path / 'survey' / 'set_1.hst').write_text('')
    with pytest.raises(TrackingError, match='survey of places'):
        open_walk(tmp_path / 'survey')
    save(tmp_path / 'ranges', record(scenario('d_stop'), 1))
    with pytest.raises(TrackingError, match='holds ranges'):
        open_walk(tmp_path / 'ranges')
    save(tmp_path / 'blind', walked(BodyConfig(duration=5.0))._replace(truth={}))
    with pytest.raises(TrackingError, match='no truth'):
        open_walk(tmp_path / 'blind')
