"""The benchmark compares like with like and tells all that it measured. Nothing here looks at a time."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.benchmarks import bags, graph, nodes, people, serial, table
from wsn_tracking.commands import bench
from wsn_tracking.evaluation import benchmark_filter as filters
from wsn_tracking.evaluation import benchmark_fusion as fusion
from wsn_tracking.evaluation import benchmark_particle as particle
from wsn_tracking.evaluation.benchmark_rows import Row, Sizes, at_least, at_most, cpu_seconds
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.models.walk import STATES

TINY = Sizes(rounds=1, least=0.0, batches=(3,), messages=120, bag_s=2.0, long_s=20.0, graph_s=0.5)


def close(one, other):
    np.testing.assert_allclose(one.m, other.m, atol=1e-10)
    np.testing.assert_allclose(one.chol_P, other.chol_P, atol=1e-10)


# --- contenders do the same work


@pytest.mark.parametrize('seed', range(5))
def test_stone_soup_computes_what_we_do(seed):
    pytest.importorskip('stonesoup')
    p = filters.problem(seed=seed)
    close(filters.stone_soup(p)(), filters.ours(p)())


@pytest.mark.parametrize('seed', range(5))
def test_filterpy_computes_what_we_do_where_it_is_right(seed):
    """At rest and without process noise: it draws no new points after a prediction."""
    pytest.importorskip('filterpy')
    p = filters.problem(q=0.0, seed=seed)._replace(F=np.eye(4))
    close(filters.filterpy(p)(), filters.ours(p)())


def test_both_forms_and_every_batch_compute_the_same():
    for batch in ((), (3,), (100,)):
        p = filters.problem(*batch)
        assert np.all((~np.isnan(p.z)).sum(axis=-1) == filters.HEARD)
        close(filters.ours(p)(), filters.ours(p, 'qr')())


@pytest.mark.parametrize('gradient', [False, True])
def test_slsqp_finds_no_better_fusion(gradient):
    pytest.importorskip('scipy')
    m, P = fusion.estimates(sets=10)
    theirs = fusion.slsqp(m, P, gradient=gradient)()
    for mine, other in zip(fusion.ours(m, P)(), theirs, strict=True):
        assert np.trace(mine.P) <= np.trace(other.P) * (1.0 + 1e-9)
        assert np.trace(mine.P) == pytest.approx(np.trace(other.P), rel=1e-5)


def test_our_fusion_is_within_1e_9_of_the_optimum():
    _, P = fusion.estimates(seed=3, sets=100)
    assert 0.0 <= fusion.gap(P) < 1e-9
    P[:, 2] = P[:, 1]
    assert fusion.gap(P) < 1e-9


def test_readers_find_the_same_ranges(tmp_path):
    pytest.importorskip('mcap_ros2')
    bag = tmp_path / 'bag'
    recording = bags.as_ranges(bags.loop(0.1, 3.0))
    save(bag, recording)
    theirs = bags.read_by_mcap(bag)
    assert len(theirs) == 30 * 12
    assert bags.ranges_of(read(bag)) == theirs == bags.ranges_of(recording)


def test_what_is_evaluated_is_tracked(tmp_path):
    save(tmp_path / 'bag', bags.loop(1.0, 60.0))
    summary = bags.evaluated(tmp_path / 'bag')
    assert summary.epochs == 60
    assert set(summary.outputs) >= {'local_1', 'local_2', 'local_3', 'fused_1', 'mean', 'lci'}
    assert summary.outputs['fused_1'].rmse_m < 0.5


def test_ci_of_the_benchmark_is_that_of_the_rule():
    m, P = fusion.estimates(sets=2)
    for one, fused in enumerate(fusion.ours(m, P)()):
        np.testing.assert_array_equal(fused.m, ci.optimal(m[one], P[one]).m)


def test_parser_of_the_benchmark_finds_every_report():
    reads = serial.pieces(serial.stream(100))
    assert serial.parsed(reads) == 100
    assert [(r.payload.node_id, r.payload.seq) for r in serial.decoded(reads)] == [
        (k % 12, k // 12) for k in range(100)
    ]


def likelihood_of_ours(p, points):
    """But for the normals' constants."""
    human, readings = particle.our_filter(p)
    s = np.zeros((STATES, points.shape[1]))
    s[:2] = points
    return human.score(s, readings).l + 16.0 * math.log(particle.SIGMA * math.sqrt(2.0 * math.pi))


@pytest.mark.parametrize('curves', [1, 2])
def test_particles_are_weighed_alike_by_all(curves):
    p = particle.problem(curves)
    points = p.start[:, :50]
    mine = likelihood_of_ours(p, points)
    table_of_loop = [(float(x), float(y), float(z)) for (x, y), z in zip(p.positions, p.z, strict=True)]
    by_loop = [particle.log_likelihood(x, y, table_of_loop, p.curves) for x, y in points.T]
    np.testing.assert_allclose(mine, by_loop, rtol=1e-9)
    if curves == 1:
        pytest.importorskip('stonesoup')
        from stonesoup.types.array import StateVectors
        from stonesoup.types.state import State

        theirs = particle.stone_soup_model(p).function(State(StateVectors(points)))
        np.testing.assert_allclose(-0.5 * np.sum(((p.z[:, None] - theirs) / particle.SIGMA) ** 2, axis=0), mine)


def test_the_package_particles_weighs_alike_where_it_is_installed():
    pytest.importorskip('particles')
    p = particle.problem(2)
    points = p.start[:, :50]
    theirs = particle.particles_model(p).PY(0, None, points.T).logpdf(p.z[None, :])
    constants = 16.0 * math.log(particle.SIGMA * math.sqrt(2.0 * math.pi))
    np.testing.assert_allclose(theirs + constants, likelihood_of_ours(p, points), rtol=1e-9)


@pytest.mark.parametrize(
    ('curves', 'name'), [(1, 'Stone Soup'), (1, 'plain loop'), (2, 'plain loop'), (2, 'particles')]
)
def test_particle_filters_follow_the_same_target(curves, name):
    """The mean over 25 steps after it has settled; runs differ by 0.1 m, one curve in the place of two makes 9 m."""
    pytest.importorskip({'Stone Soup': 'stonesoup', 'particles': 'particles'}.get(name, 'numpy'))
    p = particle.problem(curves)
    means = []
    for make in (particle.ours, particle.PEERS[name]):
        step = make(p)
        means.append(np.mean([step() for _ in range(40)][15:], axis=0))
    np.testing.assert_allclose(means[0], means[1], atol=0.5)


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


# --- timing and telling


def test_contenders_take_turns():
    calls = []
    took = cpu_seconds({'a': lambda: calls.append('a'), 'b': lambda: calls.append('b')}, TINY._replace(rounds=3))
    assert ''.join(calls) == 'aa' + 'bb' + 'ab' * 3  # first to warm up and to see how long it takes
    assert set(took) == {'a', 'b'}


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


ROWS = (
    Row('filter', 'predict', 'us', 56.789, 'filterpy', 214.3, at_least(3.2, ratio=True)),
    Row('filter', 'predict', 'us', 56.789, 'Stone Soup', None, at_least(16.0, ratio=True), note='not installed'),
    Row('fusion', 'gap', 'share', 6.1e-12, goal=at_most(1e-9)),
    Row('nodes', 'start', 'CPU s', 0.3, 'bare', 0.2, at_most(1.3, ratio=True), faster_is_more=False),
)


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


def test_figures_of_a_process_are_what_it_prints_last(monkeypatch):
    said = SimpleNamespace(returncode=0, stdout='the middleware complains\n0.5 0.25\n', stderr='')
    monkeypatch.setattr(nodes.subprocess, 'run', lambda *_, **__: said)
    assert nodes._numbers('some.module') == [0.5, 0.25]


def test_command_prints_the_table_and_writes_the_file(call, monkeypatch, tmp_path):
    monkeypatch.setattr(table, 'GROUPS', {'fusion': lambda sizes: ROWS})
    ended = call('bench', '--only', 'fusion', '--json', tmp_path / 'b.json')
    assert (ended.code, ended.out) == (0, table.format_table(ROWS) + '\n')
    assert (tmp_path / 'b.json').read_text() == table.to_json(ROWS)


def test_command_knows_every_group():
    assert tuple(table.GROUPS) == bench.GROUPS
