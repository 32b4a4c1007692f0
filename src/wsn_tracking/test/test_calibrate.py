"""The command calibrate, and what evaluate and replay do with its file."""

from __future__ import annotations

import os
from argparse import Namespace

import numpy as np
import pytest
from channel_cases import a_channel, saved

from wsn_tracking import graphs
from wsn_tracking.bags.save import save
from wsn_tracking.commands import calibrate
from wsn_tracking.commands.base import settings
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.models.radio import range_at
from wsn_tracking.offline import offline
from wsn_tracking.sensing.channel_file import calibrated, load_channel
from wsn_tracking.sensing.values import Range, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.surveys import open_survey


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """A recording of radios that do not read what its anchors say: 6 dB weaker."""
    recording = record(scenario('a_loop'), 3)
    wrong = recording.anchors._replace(p1_dbm=recording.anchors.p1_dbm + 6.0)
    path = tmp_path_factory.mktemp('bags') / 'wrong'
    save(path, recording._replace(anchors=wrong))
    return path


def test_calibrate_finds_the_radio_of_a_bag_and_evaluate_uses_it(call, bag, tmp_path):
    path = tmp_path / 'channel.yaml'
    ended = call('calibrate', bag, '--until', 60, '-o', path)
    assert ended.code == 0
    assert 'until 60 s after the first message' in ended.out
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
    path = saved(tmp_path, a_channel(map_too=False)._replace(ids=np.array([1, 2, 3])))
    anchors, _ = calibrated(path, recording.anchors)
    run = offline(source, recording, 'random_q', {'channel': path, 'peers': [1]})
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


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['--map'], 'ranges, a map is of signal strengths'),
        (['--until', '-1'], 'is no time'),
        (['-o', '/proc/none/channel.yaml'], 'cannot be written'),
    ],
)
def test_what_calibrate_cannot_do_is_told_in_one_line(call, tmp_path, arguments, said):
    recording = record(scenario('a_loop'), 3)
    ranged = tuple(
        Range(m.stamp_ns, m.node_id, m.target_id, m.seq, m.request_seq, 1, 1.0) if isinstance(m, Rssi) else m
        for m in recording.messages
        if not hasattr(m, 'topic')
    )
    save(tmp_path / 'ranged', recording._replace(messages=ranged, entry_level='range', metadata={}))
    ended = call('calibrate', tmp_path / 'ranged', '-o', tmp_path / 'x.yaml', *arguments)
    assert ended.code in {1, 2}
    assert said in ended.err.splitlines()[-1]


def test_a_bad_channel_is_refused_before_anything_starts(call, bag, tmp_path):
    for command in ('evaluate', 'replay'):
        ended = call(command, bag, '--channel', tmp_path / 'absent.yaml')
        assert ended.code == 1
        assert 'absent.yaml cannot be read' in ended.err


def test_the_channel_goes_to_the_graph_by_its_whole_path(bag, tmp_path, monkeypatch):
    saved(tmp_path, a_channel(map_too=False)._replace(ids=np.array([1, 2, 3])))
    monkeypatch.chdir(tmp_path)
    given = settings(Namespace(set=[], channel='channel.yaml'))
    assert given == {'channel': os.path.realpath('channel.yaml')}
    processes = graphs.replay(str(bag), settings=given, configuration='random_q')
    users = {p.name for p in processes if p.parameters.get('channel') == given['channel']}
    assert users >= {'sensing', 'estimator_1', 'estimator_2', 'estimator_3'}


@pytest.mark.parametrize(('half', 'warned'), [(19.0, False), (21.0, True)])
def test_radios_that_are_hardly_known_are_named(half, warned, capsys):
    channel = a_channel()
    p1 = channel.path_loss.p1_dbm
    low, high = p1.value - 1.0, p1.value + 1.0
    low[1], high[1] = p1.value[1] - half, p1.value[1] + half
    loss = channel.path_loss._replace(p1_dbm=p1._replace(low=low, high=high))
    calibrate._warn_of_open_radios(channel._replace(path_loss=loss))
    told = capsys.readouterr().err
    assert told.startswith(f'P1 of nodes {channel.ids[1]} is open') == warned
    assert (told == '') == (not warned)
