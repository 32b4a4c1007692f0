"""The command replay starts the graph that it was asked for and ends with its code."""

from __future__ import annotations

import sys


def test_replay_starts_the_graph_and_ends_with_its_code(call, bags, started, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    started.code = 3
    ended = call(
        'replay', bags / 'first', '--rate', 'max', '--json', 'scores.json', '--plot', 'plots', '--skip', 2,
        '--record', 'new', '--one-process-each', '--set', 'trigger.kind=near', '--set', 'fusion_timeout=0.5',
    )  # fmt: skip
    assert ended.code == 3
    assert started.last == ['evaluator', 'bag_recorder']
    player, evaluator = started.graph['bag_player'].parameters, started.graph['evaluator'].parameters
    assert (player['bag'], player['rate'], player['progress']) == (str(bags / 'first'), 0.0, False)
    assert (evaluator['json'], evaluator['plot'], evaluator['skip']) == (
        str(tmp_path / 'scores.json'), str(tmp_path / 'plots'), 2.0
    )  # fmt: skip
    assert started.graph['bag_recorder'].parameters['output'] == str(tmp_path / 'new')
    assert started.graph['sensing_7'].parameters['trigger.kind'] == 'near'
    assert started.graph['estimator_2'].parameters['fusion_timeout'] == 0.5


def test_replay_records_only_when_asked_to(call, bags, started):
    assert call('replay', bags / 'first').code == 0
    assert started.last == ['evaluator']
    assert started.graph['bag_player'].parameters['rate'] == 1.0
    assert 'sensing' in started.graph


def test_replay_shows_progress_on_a_terminal(call, bags, started, monkeypatch):
    monkeypatch.setattr(sys.stderr, 'isatty', lambda: True)
    assert call('replay', bags / 'first', '--rate', 20).code == 0
    assert started.graph['bag_player'].parameters['progress'] is True
    assert started.graph['bag_player'].parameters['rate'] == 20.0
