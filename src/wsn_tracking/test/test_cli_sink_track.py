"""The command that tracks behind a sink starts the graph that it was asked for."""

from __future__ import annotations

from wsn_tracking import processes


def test_the_graph_behind_a_sink_is_started_until_its_bridge_ends(call, started, tmp_path):
    started.code = 3
    ended = call(
        'sink', 'track', 'my_sink', '--trackers', 'random_q,hybrid', '--level', 'range', '--set', 'period=0.5',
        '--record', tmp_path / 'walk',
    )  # fmt: skip
    assert ended.code == 3
    assert started.last == ['serial_bridge']
    bridge = started.graph['serial_bridge'].parameters
    assert (bridge['port'], bridge['period']) == ('my_sink', 0.5)
    assert started.graph['estimator_1'].parameters['input'] == 'range'
    assert 'hybrid_tracker' in started.graph
    assert started.graph['bag_recorder'].parameters['output'] == str(tmp_path / 'walk')


def test_the_port_is_that_of_the_configuration_where_none_is_named(call, started):
    assert call('sink', 'track').code == 0
    assert started.graph['serial_bridge'].parameters['port'] == '/dev/ttyACM0'
    assert 'bag_recorder' not in started.graph


def test_ctrl_c_is_how_it_ends(call, monkeypatch):
    def interrupted(_graph, _last):
        raise KeyboardInterrupt

    monkeypatch.setattr(processes, 'run_graph', interrupted)
    assert call('sink', 'track').code == 0


def test_a_bag_that_is_there_is_refused_before_anything_starts(call, started, tmp_path):
    (tmp_path / 'walk').mkdir()
    (tmp_path / 'walk' / 'kept').touch()
    ended = call('sink', 'track', '--record', tmp_path / 'walk')
    assert ended.code == 1
    assert ended.err.count('\n') == 1
    assert not hasattr(started, 'graph')
