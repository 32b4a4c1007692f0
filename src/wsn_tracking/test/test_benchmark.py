"""The benchmark compares like with like: all contenders compute the same."""

import math

import numpy as np
import pytest
from benchmark_cases import TINY

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.benchmarks import bags, filters, fusion, serial
from wsn_tracking.benchmarks import particles as particle
from wsn_tracking.benchmarks.rows import cpu_seconds
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.models.walk import STATES
from wsn_tracking.sensing.values import Range


def close(one, other):
    np.testing.assert_allclose(one.m, other.m, atol=1e-10)
    np.testing.assert_allclose(one.chol_P, other.chol_P, atol=1e-10)


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
    for mine in (read(bag), recording):
        assert [(m.node_id, m.range) for m in mine.messages if isinstance(m, Range)] == theirs


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


def test_contenders_take_turns():
    calls = []
    took = cpu_seconds({'a': lambda: calls.append('a'), 'b': lambda: calls.append('b')}, TINY._replace(rounds=3))
    assert ''.join(calls) == 'aa' + 'bb' + 'ab' * 3  # first to warm up and to see how long it takes
    assert set(took) == {'a', 'b'}
