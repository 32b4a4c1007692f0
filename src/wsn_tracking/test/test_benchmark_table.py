"""The benchmark tells all that it measured, and what it could not. Nothing here looks at a time."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from benchmark_cases import TINY

from wsn_tracking.benchmarks import filters, graph, nodes, people, table
from wsn_tracking.benchmarks import particles as particle
from wsn_tracking.benchmarks.rows import Row, at_least, at_most
from wsn_tracking.commands import bench

ROWS = (
    Row('filter', 'predict', 'us', 56.789, 'filterpy', 214.3, at_least(3.2, ratio=True)),
    Row('filter', 'predict', 'us', 56.789, 'Stone Soup', None, at_least(16.0, ratio=True), note='not installed'),
    Row('fusion', 'gap', 'share', 6.1e-12, goal=at_most(1e-9)),
    Row('nodes', 'start', 'CPU s', 0.3, 'bare', 0.2, at_most(1.3, ratio=True), faster_is_more=False),
)


@pytest.mark.parametrize(
    ('row', 'ratio', 'met'),
    [
        (Row('g', 'w', 'us', 2.0, 'p', 8.0, at_least(4.0, ratio=True)), 4.0, True),
        (Row('g', 'w', 'us', 2.0, 'p', 8.0, at_least(5.0, ratio=True)), 4.0, False),
        (Row('g', 'w', 'us', 2.0, 'p', None, at_least(5.0, ratio=True)), None, None),
        (Row('g', 'w', 's', 6.0, 'p', 4.0, at_most(1.5, ratio=True), faster_is_more=False), 1.5, True),
        (Row('g', 'w', 's', 6.0, goal=at_most(5.0)), None, False),
        (Row('g', 'w', 'ranges/s', 6.0, goal=at_least(5.0)), None, True),
        (Row('g', 'w', 'ranges/s', None, goal=at_least(5.0), note='broken'), None, None),
        (Row('g', 'w', 'us', 1.0), None, None),
    ],
)
def test_a_goal_is_met_missed_or_not_known(row, ratio, met):
    assert row.ratio == ratio
    assert (row.goal.met(row) if row.goal else None) is met


def test_table_shows_every_figure():
    lines = table.format_table(ROWS).splitlines()
    assert lines[0].split() == ['work', 'ours', 'peer', 'ratio', 'goal']
    assert lines[1].split() == ['predict', '56.8', 'us', 'filterpy', '214', 'us', '3.77', 'x', '>=', '3.2', 'x', 'ok']
    assert lines[2].split() == ['predict', '[1]', '56.8', 'us', 'Stone', 'Soup', '-', 'us', '>=', '16', 'x']
    assert lines[3] == ''
    assert lines[4].split() == ['gap', '6.1e-12', 'share', '<=', '1e-09', 'ok']
    assert ' '.join(lines[6].split()) == 'start 0.3 CPU s bare 0.2 CPU s 1.5 x <= 1.3 x not met'
    assert lines[-1] == '[1] not installed'


def test_json_holds_every_row():
    content = json.loads(table.to_json(ROWS))
    assert content['machine']['cores'] >= 1
    assert content['packages']['numpy'] == np.__version__
    assert [row['work'] for row in content['rows']] == [row.work for row in ROWS]
    assert content['rows'][0]['met'] is True
    assert content['rows'][0]['goal'] == {'of': 'ratio', 'at_least': 3.2}
    assert content['rows'][1]['theirs'] is content['rows'][1]['ratio'] is content['rows'][1]['met'] is None
    assert content['rows'][3]['ratio'] == pytest.approx(1.5)


@pytest.mark.parametrize('group', ['filter', 'fusion', 'bags', 'serial'])
def test_a_group_tells_a_figure_for_every_work(group):
    pytest.importorskip('scipy')
    rows = list(table.benchmark([group], TINY))
    assert {row.group for row in rows} == {group}
    for row in rows:
        assert row.ours is not None
        assert math.isfinite(row.ours)
        assert row.theirs is not None or row.note or not row.peer
    assert table.format_table(rows)
    assert len(json.loads(table.to_json(rows))['rows']) == len(rows)


def test_the_share_of_a_core_is_of_the_time_when_all_is_started():
    """Two seconds at the start, then a twentieth."""
    samples = [(float(t), 2.0 * min(t, 1) + 0.05 * t) for t in range(10)]
    assert graph.share_of(samples) == pytest.approx(0.05)
    assert graph.share_of(samples[:3]) is None
    assert graph.share_of([]) is None


def test_people_are_told_by_share_and_by_speed(monkeypatch):
    played = graph.Played(40, 20.0, 3.0, 0.02)
    asked = []
    monkeypatch.setattr(people, 'play', lambda _graph, timeout, watch: asked.append((timeout, watch)) or played)
    shares, speeds = people.rows(TINY._replace(walk_s=1.0))
    assert (shares.ours, speeds.ours) == (2.0, 3.0)
    assert {watch for _, watch in asked} == {'human_tracker'}


def test_figures_of_a_process_are_what_it_prints_last(monkeypatch):
    said = SimpleNamespace(returncode=0, stdout='the middleware complains\n0.5 0.25\n', stderr='')
    monkeypatch.setattr(nodes.subprocess, 'run', lambda *_, **__: said)
    assert nodes._numbers('some.module') == [0.5, 0.25]


# ---- what cannot be measured


def test_a_peer_that_is_not_installed_is_said_and_not_fatal(monkeypatch):
    def missing(problem):
        raise ModuleNotFoundError("No module named 'filterpy'", name='filterpy')

    monkeypatch.setitem(filters.PEERS, 'filterpy', missing)
    rows = [row for row in filters.rows(TINY) if row.peer == 'filterpy']
    assert len(rows) == 2
    for row in rows:
        assert row.ours is not None
        assert row.theirs is row.ratio is None
        assert 'filterpy' in row.note


def test_a_particle_filter_that_is_not_installed_is_said_and_not_fatal(monkeypatch):
    def missing(problem):
        raise ModuleNotFoundError("No module named 'particles'", name='particles')

    pytest.importorskip('stonesoup')
    monkeypatch.setitem(particle.PEERS, 'particles', missing)
    rows = list(particle.rows(TINY))
    assert {row.group for row in rows} == {'particles'}
    for row in rows:
        assert row.ours is not None
        assert ('not installed' in row.note) == (row.peer == 'particles')


def test_a_graph_that_cannot_start_is_said_and_not_fatal(monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', '')
    (row,) = graph.rows(TINY)
    assert row.ours is None
    assert 'not installed' in row.note
    (row,) = people.rows(TINY)
    assert 'not installed' in row.note


def test_nodes_that_cannot_start_are_said_and_not_fatal(monkeypatch):
    monkeypatch.setattr(nodes, 'MODULES', 'no_such_package')
    (row,) = nodes.rows(TINY)
    assert row.ours is None
    assert 'No module named' in row.note


# ---- the command


def test_command_prints_the_table_and_writes_the_file(call, monkeypatch, tmp_path):
    monkeypatch.setattr(table, 'GROUPS', {'fusion': lambda sizes: ROWS})
    ended = call('bench', '--only', 'fusion', '--json', tmp_path / 'b.json')
    assert (ended.code, ended.out) == (0, table.format_table(ROWS) + '\n')
    assert (tmp_path / 'b.json').read_text() == table.to_json(ROWS)


def test_command_knows_every_group():
    assert tuple(table.GROUPS) == bench.GROUPS
