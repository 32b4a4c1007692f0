"""Channel files: what is written comes back, what is broken is refused in one line, and who uses them does."""

from __future__ import annotations

import logging
import os
import re
from pathlib import Path

import numpy as np
import pytest
from import_cases import folder, real_data
from test_import_danis import flat
from test_import_kolakowski import EXPONENT, P1
from test_import_kolakowski import files as flat_of_kolakowski

from wsn_tracking import graphs
from wsn_tracking.bags.save import save
from wsn_tracking.cli import main
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import rssi_function
from wsn_tracking.models.radio import range_at
from wsn_tracking.models.radio_map import residual
from wsn_tracking.offline import offline
from wsn_tracking.sensing.channel import (
    Channel,
    Quantity,
    Ranging,
    apply,
    calibrated,
    check_channel,
    lacking,
    load_channel,
    save_channel,
)
from wsn_tracking.sensing.channel_file import channel_text, parse_channel
from wsn_tracking.sensing.channel_fit import fit_path_loss
from wsn_tracking.sensing.survey import survey_of_places
from wsn_tracking.sensing.values import Epoch, Range, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.surveys import open_survey
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator

IDS = [3, 7, 20]
POSITIONS = [[0.0, 0.0, 2.0], [8.0, 0.0, 2.0], [0.0, 8.0, 2.0]]


def quantity(*values):
    value = np.array(values, dtype=np.float64)
    return Quantity(value, np.full(value.size, 0.1), value - 0.2, value + 0.2)


def a_channel(map_too=True, ranging=True):
    rng = np.random.default_rng(0)
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-55.0, n=2.0)
    places = np.column_stack([rng.uniform(0.0, 8.0, (25, 2)), np.ones(25)])
    d = np.linalg.norm(places[:, None] - anchors.positions, axis=-1)
    y = -55.0 - 20.0 * np.log10(d) + 3.0 * np.sin(places[:, :1] + np.arange(3)) + rng.normal(0.0, 1.0, (25, 3))
    y[3, 1] = np.nan
    survey = survey_of_places(anchors, places, y, np.full(y.shape, 2.0), np.isfinite(y) * 9.0)
    loss, radio_map, _ = fit_path_loss(survey)
    counts = np.array([4, 5, 6])
    ranges = Ranging(quantity(0.1, -0.2, 0.0), quantity(1.0, 1.07, 0.99), quantity(0.3, 0.4, 0.5), counts, counts)
    origin = {'bag': "it's a: bag # {x}", 'until': '15 s'}
    return Channel(np.array(IDS), loss, ranges if ranging else None, radio_map if map_too else None, origin)


def flattened(value):
    if isinstance(value, tuple):
        return [part for each in value for part in flattened(each)]
    return [] if value is None else [np.asarray(value)]


def test_what_is_saved_comes_back(tmp_path):
    channel = a_channel()
    path = tmp_path / 'new' / 'channel.yaml'
    save_channel(path, channel)
    back = load_channel(path)
    assert back.origin == channel.origin
    for ours, theirs in zip(flattened(channel[:3]), flattened(back[:3]), strict=True):
        np.testing.assert_allclose(theirs, ours, rtol=1e-5, atol=1e-9)
    x = np.random.default_rng(1).uniform(0.0, 8.0, (50, 4))
    np.testing.assert_allclose(residual(back.radio_map, x), residual(channel.radio_map, x), atol=1e-3)
    assert back.radio_map.residual_db.shape == (25, 3)
    assert np.isnan(back.radio_map.residual_db[3, 1])


def test_a_file_that_was_read_is_written_unchanged():
    text = channel_text(a_channel())
    assert channel_text(parse_channel(text, 'x')) == text


@pytest.mark.parametrize('map_too', [True, False])
@pytest.mark.parametrize('ranging', [True, False])
def test_parts_may_be_absent(map_too, ranging):
    back = parse_channel(channel_text(a_channel(map_too, ranging)), 'x')
    assert (back.radio_map is not None) == map_too
    assert (back.ranging is not None) == ranging
    ranges = a_channel()._replace(path_loss=None, radio_map=None)
    assert parse_channel(channel_text(ranges), 'x').path_loss is None


def test_saving_is_whole_or_not_at_all(tmp_path):
    path = tmp_path / 'channel.yaml'
    path.write_text('before')
    save_channel(path, a_channel(map_too=False))
    assert path.read_text().startswith('# Radios')
    assert [p.name for p in tmp_path.iterdir()] == ['channel.yaml']
    (tmp_path / 'file').write_text('')
    with pytest.raises(TrackingError, match='cannot be written'):
        save_channel(tmp_path / 'file' / 'channel.yaml', a_channel(map_too=False))


GOOD = channel_text(a_channel())


def changed(pattern, new, count=1):
    text, n = re.subn(pattern, new, GOOD, count=count, flags=re.DOTALL)
    assert n
    return text


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('', '`format` is .NoneType'),
        ('hello', '`format`'),
        ('[1, 2]', '`format`'),
        ('{', 'no readable YAML'),
        ('format: wsn_tracking channel 2', "`format` is 'wsn_tracking channel 2'"),
        ('format: wsn_tracking channel 1', 'neither `path_loss` nor `ranging`'),
        (GOOD + 'extra: 1\n', 'sections'),
        (changed('origin:.*?# Signal', 'origin: 3\n# Signal'), '`origin` is 3'),
        (changed('path_loss:.*?# Range', 'path_loss: 3\n# Range'), '`path_loss` is 3'),
        (changed('path_loss:.*?# Range', '# Range'), '`map` without `path_loss`'),
        (changed(r'\n  20: \{p1', r'\n  21: {p1'), 'of different nodes'),
        (changed(r'\n  3: \{p1', r'\n  -3: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1', r'\n  70000: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1', r'\n  x: {p1'), 'ids from 0 to 65535'),
        (changed(r'\n  3: \{p1_dbm', r'\n  3: {p2_dbm'), 'values of p1_dbm, n, sigma_db'),
        (changed(r'\n  3: \{p1[^\n]*', r'\n  3: []'), 'values of p1_dbm'),
        (changed(r' n: \[[^]]*', ' n: [.nan, 0.1, 1.0, 3.0'), '`n` of node 3'),
        (changed(r' n: \[[^]]*', ' n: [2.0, 0.1, 1.0'), '4 finite numbers'),
        (changed(r' n: \[[^]]*', ' n: [-2.0, 0.1, -3.0, -1.0'), 'a value from 0.01 to 20'),
        (changed(r' n: \[[^]]*', ' n: [2.0, -0.1, 1.0, 3.0'), 'with a standard deviation'),
        (changed(r' n: \[[^]]*', ' n: [2.0, 0.1, 3.0, 4.0'), 'within its interval'),
        (changed(r' n: \[[^]]*', ' n: [true, 0.1, 0.0, 4.0'), '4 finite numbers'),
        (changed(r'sigma_db: \[[^]]*', 'sigma_db: [0.0, 0.0, 0.0, 0.0'), '`sigma_db` of node 3'),
        (changed(r'scale: \[[^]]*\]', 'scale: 3'), '`scale` of node 3 is 3'),
        (changed('places: 25', 'places: -1'), '`places` of node 3 is -1'),
        (changed(r'readings: \d+', 'readings: 1.5'), '`readings` of node 3 is 1.5'),
        (changed('amplitude_db: [^\n]*', 'amplitude_db: -1.0'), 'amplitude_db >= 0'),
        (changed('length: [^\n]*', 'length: 0.0'), 'length > 0'),
        (changed('length: [^\n]*', 'length: far'), '2 finite numbers'),
        (changed('  length: [^\n]*\n', ''), '`map` holds'),
        (changed('map:.*', 'map: 7\n'), '`map` holds 7'),
        (changed(r'    7: \[[^\n]*\n', ''), 'of nodes .3, 20.'),
        (changed(r'    7: \[[^\n]*', r'    7: [-50.0, 2.0, -1.0, 2.0]'), 'place_db >= 0'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    1e999'), 'infinite'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    -'), 'different places'),
        (changed(r'residual_db: \|\n    \S+', 'residual_db: |\n    x'), 'residual_db. of `map`: could not convert'),
        (changed(r'residual_db: \|\n    \S+ ', 'residual_db: |\n    '), 'rows of 5 numbers'),
        (changed(r'noise_db: \|\n[^\n]*\n', 'noise_db: |\n'), 'different places'),
        (changed('noise_db: .*', 'noise_db: 5\n'), '`noise_db` of `map` has 0 rows'),
        (changed(r'(noise_db: \|\n    \S+ \S+) \S+', r'\1 0.0'), 'noise_db >= 1e-6'),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, text, said):
    path = tmp_path / 'channel.yaml'
    path.write_text(text)
    with pytest.raises(TrackingError, match=said) as error:
        load_channel(path)
    assert 'channel.yaml' in str(error.value)
    assert '\n' not in str(error.value)
    assert len(str(error.value)) < 500


@pytest.mark.parametrize('where', ['absent.yaml', '.', 'binary'])
def test_what_is_no_text_is_refused(tmp_path, where):
    (tmp_path / 'binary').write_bytes(b'\xff\xfe\x00')
    with pytest.raises(TrackingError, match='cannot be read'):
        check_channel(str(tmp_path / where))
    check_channel('')


def test_places_without_end_are_refused():
    rows = '\n'.join(f'    {i} 0.0 1.0 1.0 1.0' for i in range(5001))
    text = changed(r'residual_db: \|.*', f'residual_db: |\n{rows}\n  noise_db: |\n{rows}\n')
    with pytest.raises(TrackingError, match='5001 rows; expected 1 to 5000'):
        parse_channel(text, 'x')


def test_the_radio_replaces_that_of_the_anchors():
    channel = a_channel()
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-40.0, d0=2.0, n=4.0, sigma_db=9.0, bias=5.0, scale=2.0)
    ours = apply(channel, anchors)
    assert np.array_equal(ours.p1_dbm, channel.path_loss.p1_dbm.value)
    assert np.array_equal(ours.n, channel.path_loss.n.value)
    assert np.array_equal(ours.sigma_db, channel.path_loss.sigma_db.value)
    assert ours.d0.tolist() == [1.0, 1.0, 1.0]
    assert ours.bias.tolist() == [0.1, -0.2, 0.0]
    assert ours.scale.tolist() == [1.0, 1.07, 0.99]
    assert np.array_equal(ours.positions, anchors.positions)
    only = apply(channel._replace(path_loss=None), anchors)
    assert np.array_equal(only.p1_dbm, anchors.p1_dbm)
    assert only.scale.tolist() == [1.0, 1.07, 0.99]


def test_nodes_that_the_file_lacks_keep_their_radio_and_that_is_said(tmp_path, caplog):
    path = str(tmp_path / 'channel.yaml')
    save_channel(path, a_channel())
    anchors = make_anchors([2, 7, 20], POSITIONS, p1_dbm=-40.0, d0=2.0)
    with caplog.at_level(logging.WARNING):
        ours, radio_map = calibrated(path, anchors)
    assert 'lacks nodes [2]' in caplog.text
    assert ours.p1_dbm[0] == -40.0
    assert ours.d0.tolist() == [2.0, 1.0, 1.0]
    assert ours.bias.tolist() == [0.0, -0.2, 0.0]
    assert radio_map is not None
    assert lacking(a_channel(), anchors) == (2,)


def test_more_nodes_than_the_anchors_have_do_no_harm(tmp_path, caplog):
    path = str(tmp_path / 'channel.yaml')
    save_channel(path, a_channel())
    ours, _ = calibrated(path, make_anchors([20], [POSITIONS[2]]))
    assert ours.scale.tolist() == [0.99]
    assert not caplog.text
    anchors = make_anchors(IDS, POSITIONS)
    assert calibrated('', anchors) == (anchors, None)


def test_a_calibration_for_other_nodes_is_refused(tmp_path):
    path = str(tmp_path / 'channel.yaml')
    save_channel(path, a_channel())
    with pytest.raises(TrackingError, match=r'channel.yaml.*nodes \[3, 7, 20\], none of which .* \[1, 2\]'):
        calibrated(path, make_anchors([1, 2], POSITIONS[:2]))


# ---- who uses it


def packet(node, rssi, sigma=np.nan):
    return Rssi(0, node, 1, 0, 0, rssi, sigma)


def test_an_estimator_filters_signal_strengths_with_the_map(tmp_path):
    channel = a_channel()
    path = str(tmp_path / 'channel.yaml')
    save_channel(path, channel)
    anchors = make_anchors(IDS, POSITIONS, p1_dbm=-40.0)
    local, _ = make_estimator(EstimatorConfig(channel=path, nodes=(3, 20), target_height=1.0), anchors)
    heard = local.table.read(Epoch(1, 0, 0, (packet(3, -60.0), packet(20, -61.0, 9.0))))
    x = np.array([[2.0, 3.0, 0.0, 0.0], [5.0, 1.0, 0.0, 0.0]])
    radio_map = load_channel(path).radio_map
    mean, std = (part[:, [0, 2]] for part in residual(radio_map, x))
    own = make_anchors([3, 20], [POSITIONS[0], POSITIONS[2]], p1_dbm=radio_map.p1_dbm[[0, 2]], n=radio_map.n[[0, 2]])
    np.testing.assert_allclose(heard.h(x), rssi_function(own, 1.0)(x) + mean)
    packets = np.array([radio_map.packet_db[0], 9.0])  # what comes along counts before what is calibrated
    np.testing.assert_allclose(heard.noise(x) ** 2, std**2 + radio_map.place_db[[0, 2]] ** 2 + packets**2)


def test_the_map_leaves_ranges_alone(tmp_path):
    path = str(tmp_path / 'channel.yaml')
    save_channel(path, a_channel())
    anchors = make_anchors(IDS, POSITIONS)
    mapped, _ = make_estimator(EstimatorConfig(channel=path), anchors)
    plain, _ = make_estimator(EstimatorConfig(), apply(load_channel(path), anchors))
    epoch = Epoch(1, 0, 0, (Range(0, 3, 1, 0, 0, 1, 4.0), Range(0, 7, 1, 0, 0, 1, 5.0)))
    x = np.array([[2.0, 3.0, 0.0, 0.0]])
    ours, theirs = mapped.table.read(epoch), plain.table.read(epoch)
    np.testing.assert_array_equal(ours.h(x), theirs.h(x))
    np.testing.assert_array_equal(ours.noise(x), theirs.noise(x))


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """A recording of radios that do not read what its anchors say: 6 dB weaker."""
    recording = record(scenario('a_loop'), 3)
    wrong = recording.anchors._replace(p1_dbm=recording.anchors.p1_dbm + 6.0)
    path = tmp_path_factory.mktemp('bags') / 'wrong'
    save(path, recording._replace(anchors=wrong))
    return path


def test_calibrate_finds_the_radio_of_a_bag_and_evaluate_uses_it(bag, tmp_path, capsys):
    path = tmp_path / 'channel.yaml'
    with pytest.raises(SystemExit, match='0'):
        main(['calibrate', str(bag), '--until', '60', '-o', str(path)])
    said = capsys.readouterr().out
    assert 'until 60 s after the first message' in said
    loss = load_channel(path).path_loss
    assert np.mean((loss.p1_dbm.low <= -45.0) & (loss.p1_dbm.high >= -45.0)) > 0.8
    assert np.mean((loss.n.low <= 3.0) & (loss.n.high >= 3.0)) > 0.8
    assert load_channel(path).origin['until'] == '60 s after the first message'
    source, recording = graphs.open_bag(str(bag))

    def rmse(settings):
        run = offline(source, recording, 'random_q', settings)
        return summarise('x', recording, run, 5.0).outputs['fused_1'].rmse_m

    near = {'trigger.kind': 'near', 'trigger.y_min': -60.0}
    assert rmse({**near, 'channel': str(path)}) < 0.6 * rmse(near)


def test_sensing_nodes_invert_with_the_channel(bag, tmp_path):
    source, recording = graphs.open_bag(str(bag))
    path = tmp_path / 'channel.yaml'
    save_channel(path, a_channel(map_too=False)._replace(ids=np.array([1, 2, 3])))
    anchors, _ = calibrated(str(path), recording.anchors)
    run = offline(source, recording, 'random_q', {'channel': str(path), 'peers': [1]})
    assert run.reports
    y = np.full(12, -50.0)
    assert np.all(range_at(anchors, y)[:3] != range_at(recording.anchors, y)[:3])
    plain = offline(source, recording, 'random_q', {'peers': [1]})
    assert not np.array_equal(run.estimates['local_1'][20].mean, plain.estimates['local_1'][20].mean)


def test_a_time_slice_leaves_the_rest_unseen(bag):
    early, whole = open_survey(bag, 30.0), open_survey(bag)
    assert early.survey.counts.sum() < 0.3 * whole.survey.counts.sum()
    assert not early.ranges
    with pytest.raises(TrackingError, match='no signal strength or range within 0 s'):
        open_survey(bag, 0.0)


def test_a_bag_without_truth_or_a_folder_of_nothing_is_refused(tmp_path):
    recording = record(scenario('a_loop'), 3)
    save(tmp_path / 'blind', recording._replace(truth={}))
    with pytest.raises(TrackingError, match='holds no truth'):
        open_survey(tmp_path / 'blind')
    (tmp_path / 'nothing').mkdir()
    with pytest.raises(TrackingError, match='neither a bag'):
        open_survey(tmp_path / 'nothing')
    with pytest.raises(TrackingError, match='does not exist'):
        open_survey(tmp_path / 'absent')


def test_surveys_are_known_by_their_files(tmp_path):
    danis = open_survey(flat(tmp_path / 'danis'))
    assert danis.survey.ids.tolist() == [10, 11, 20]
    assert danis.survey.points.shape == (25, 2)
    loss, _, _ = fit_path_loss(danis.survey)
    np.testing.assert_allclose(loss.p1_dbm.value, -58.0, atol=0.3)
    np.testing.assert_allclose(loss.n.value, 1.8, atol=0.05)
    np.testing.assert_allclose(loss.sigma_db.value, 3.0, atol=0.2)
    assert loss.readings.tolist() == [0, 0, 0]  # histograms do not tell
    kolakowski = open_survey(folder(tmp_path / 'kolakowski', flat_of_kolakowski()))
    loss, _, _ = fit_path_loss(kolakowski.survey)
    np.testing.assert_allclose(loss.p1_dbm.value, P1, atol=0.5)
    np.testing.assert_allclose(loss.n.value, EXPONENT, atol=0.1)
    with pytest.raises(TrackingError, match='leave out --until'):
        open_survey(tmp_path / 'danis', 5.0)


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['--map'], 'ranges, a map is of signal strengths'),
        (['--until', '-1'], 'is no time'),
        (['-o', '/proc/none/channel.yaml'], 'cannot be written'),
    ],
)
def test_what_calibrate_cannot_do_is_told_in_one_line(tmp_path, capsys, arguments, said):
    recording = record(scenario('a_loop'), 3)
    ranged = tuple(
        Range(m.stamp_ns, m.node_id, m.target_id, m.seq, m.request_seq, 1, 1.0) if isinstance(m, Rssi) else m
        for m in recording.messages
        if not hasattr(m, 'topic')
    )
    save(tmp_path / 'ranged', recording._replace(messages=ranged, entry_level='range', metadata={}))
    with pytest.raises(SystemExit) as end:
        main(['calibrate', str(tmp_path / 'ranged'), '-o', str(tmp_path / 'x.yaml'), *arguments])
    assert end.value.code in (1, 2)
    assert said in capsys.readouterr().err


def test_a_bad_channel_is_refused_before_anything_starts(bag, tmp_path, capsys):
    for command in ('evaluate', 'replay'):
        with pytest.raises(SystemExit, match='1'):
            main([command, str(bag), '--channel', str(tmp_path / 'absent.yaml')])
        assert 'absent.yaml cannot be read' in capsys.readouterr().err


def test_the_channel_goes_to_the_graph_by_its_whole_path(bag, tmp_path, monkeypatch):
    save_channel(tmp_path / 'channel.yaml', a_channel(map_too=False)._replace(ids=np.array([1, 2, 3])))
    monkeypatch.chdir(tmp_path)
    from argparse import Namespace

    from wsn_tracking.commands.base import settings

    given = settings(Namespace(set=[], channel='channel.yaml'))
    assert given == {'channel': os.path.realpath('channel.yaml')}
    processes = graphs.replay(str(bag), settings=given, configuration='random_q')
    users = {p.name for p in processes if p.parameters.get('channel') == given['channel']}
    assert users >= {'sensing', 'estimator_1', 'estimator_2', 'estimator_3'}


@pytest.fixture(scope='module')
def danis_folder():
    return real_data('danis_ble_tracks')


def test_the_real_survey_is_predicted_better_by_the_map(danis_folder):
    found = open_survey(Path(danis_folder))
    _, radio_map, told = fit_path_loss(found.survey)
    line, mapped = (float(x) for x in re.findall(r'(\d+\.\d+) dB', told['left_out']))
    assert line == pytest.approx(3.94, abs=0.1)
    assert mapped < 0.92 * line
    assert 2.0 < radio_map.amplitude_db < 3.5
    assert 3.0 < radio_map.length < 6.0
