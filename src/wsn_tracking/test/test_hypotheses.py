"""A mixture of places: against the posterior on a fine grid, and what it does with its members."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import covariances, properties

from wsn_tracking.filters import hypotheses as hy
from wsn_tracking.filters.ekf import Gaussian

BOX = (-4.0, -4.0, 4.0, 4.0)
NODES = np.array([[0.0, 0.0, 0.0], [2.0, 0.5, 0.0], [-1.0, 2.5, 0.0]])


def grid_posterior(ranges, std):
    """Mean and covariance of a flat prior over BOX given ranges of NODES, cell by cell."""
    axis = np.linspace(-4.0, 4.0, 401)
    x = np.stack(np.meshgrid(axis, axis, indexing='ij'), axis=-1).reshape(-1, 2)
    log_p = np.zeros(len(x))
    for node, z in ranges:
        log_p -= 0.5 * ((np.linalg.norm(x - NODES[node, :2], axis=-1) - z) / std) ** 2
    p = np.exp(log_p - log_p.max())
    p /= p.sum()
    mean = p @ x
    return mean, (x - mean).T @ ((x - mean) * p[:, None])


def told(ranges, std):
    (node, z), *rest = ranges
    places = hy.ring(NODES[node, :2], z, std, BOX, 0.1, 60)
    for node, z in rest:
        places, _ = hy.update(places, z, NODES[node], std, 0.0, 0.0)
    return places


@pytest.mark.parametrize(
    ('ranges', 'modes'),
    [
        ([(0, 2.0)], 12),
        ([(0, 2.0), (1, 1.2)], 2),
        ([(0, 2.0), (1, 1.2), (2, 2.4)], 1),
        ([(0, 2.0), (1, 1.2), (1, 1.2), (0, 2.1)], 2),
    ],
)
def test_a_few_ranges_leave_the_places_that_a_grid_leaves(ranges, modes):
    std = 0.2
    mean, P = grid_posterior(ranges, std)
    found = hy.moments(hy.reduced(told(ranges, std), 60))
    size = np.sqrt(np.trace(P))
    np.testing.assert_allclose(found.m[:2], mean, atol=0.12 * size)
    np.testing.assert_allclose(found.P[:2, :2], P, atol=0.25 * np.trace(P))
    assert len(hy.reduced(told(ranges, std), 60).w) >= modes


def test_a_third_circle_tells_which_of_two_cuts_it_is():
    both = hy.reduced(told([(0, 2.0), (1, 1.2)], 0.05), 60)
    assert np.sqrt(np.trace(hy.moments(both).P[:2, :2])) > 0.5
    x = hy.moments(both._replace(w=np.eye(len(both.w))[np.argmax(both.w)])).m[:2]
    one = hy.reduced(hy.update(both, float(np.linalg.norm(x - NODES[2, :2])), NODES[2], 0.05, 0.0, 0.0)[0], 60)
    assert np.linalg.norm(hy.moments(one).m[:2] - x) < 0.1
    assert np.sqrt(np.trace(hy.moments(one).P[:2, :2])) < 0.1


@properties
@given(st.integers(0, 10**6), st.floats(0.5, 8.0))
def test_splitting_changes_neither_mean_nor_covariance(seed, wide):
    rng = np.random.default_rng(seed)
    prior = hy.one(Gaussian(rng.uniform(-2.0, 2.0, 4), wide * covariances(rng, condition=10.0)))
    places, done = hy.split(prior, 1.0, np.zeros(3))
    before, after = hy.moments(prior), hy.moments(places)
    assert places.w.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(after.m, before.m, atol=1e-9)
    np.testing.assert_allclose(after.P, before.P, atol=1e-9 * wide)
    assert done == (len(places.w) == 1)


@properties
@given(st.integers(0, 10**6), st.integers(2, 30))
def test_reducing_keeps_mean_and_weight_and_no_more_than_is_wanted(seed, most):
    rng = np.random.default_rng(seed)
    m = np.concatenate([rng.uniform(-3.0, 3.0, (20, 2)), np.zeros((20, 2))], axis=-1)
    places = hy.Hypotheses(m, 0.3 * covariances(rng, 20, condition=5.0), rng.dirichlet(np.ones(20)))
    fewer = hy.reduced(places, most)
    assert len(fewer.w) <= most
    assert fewer.w.sum() == pytest.approx(1.0)
    if most >= 20:
        np.testing.assert_allclose(hy.moments(fewer).m, hy.moments(places).m, atol=0.05)
        np.testing.assert_allclose(hy.moments(fewer).P, hy.moments(places).P, atol=0.2)


def test_evidence_is_the_density_of_the_range():
    """Of one Gaussian, by drawing from it: the linearisation of second order is close where the circle bends little."""
    rng = np.random.default_rng(1)
    prior = Gaussian(np.array([3.0, 1.0, 0.0, 0.0]), np.diag([0.04, 0.09, 0.01, 0.01]))
    x = prior.m[:2] + np.sqrt([0.04, 0.09]) * rng.standard_normal((200000, 2))
    d = np.linalg.norm(x, axis=-1)
    for z in (3.0, 3.4):
        density = np.mean(np.exp(-0.5 * ((z - d) / 0.1) ** 2) / np.sqrt(2.0 * np.pi * 0.01))
        _, log_l = hy.update(hy.one(prior), z, np.zeros(3), 0.1, 0.0, 0.0)
        assert np.exp(log_l) == pytest.approx(density, rel=0.05)


def test_heavy_tails_forgive_one_wrong_range():
    good = told([(0, 2.0), (1, 1.2), (2, 2.4)], 0.05)
    mean = hy.moments(good).m[:2]
    wrong = float(np.linalg.norm(mean)) + 1.0
    gaussian, _ = hy.update(good, wrong, NODES[0], 0.05, 0.0, 0.0)
    student, _ = hy.update(good, wrong, NODES[0], 0.05, 0.0, 4.0)
    moved = [np.linalg.norm(hy.moments(p).m[:2] - mean) for p in (gaussian, student)]
    assert moved[1] < 0.3 * moved[0]


def test_a_ring_stays_inside_where_any_of_it_is():
    inside = hy.ring(np.array([3.5, 0.0]), 2.0, 0.1, BOX, 0.1, 60)
    assert inside.m[:, 0].max() <= 4.0
    np.testing.assert_allclose(np.linalg.norm(inside.m[:, :2] - [3.5, 0.0], axis=-1), 2.0)
    outside = hy.ring(np.array([30.0, 0.0]), 2.0, 0.1, BOX, 0.1, 60)
    assert len(outside.w) == 25  # 2 pi 2 m / 0.5 m


def test_places_beyond_the_area_fade_and_either_of_two_mixtures_is_their_sum():
    m = np.array([[0.0, 0.0, 0.0, 0.0], [4.4, 0.0, 0.0, 0.0]])
    places = hy.Hypotheses(m, np.broadcast_to(np.eye(4), (2, 4, 4)), np.array([0.5, 0.5]))
    faded = hy.kept_inside(places, BOX, 0.4)
    assert faded.w[1] / faded.w[0] == pytest.approx(np.exp(-0.5))
    both = hy.together(places, faded, 0.25)
    np.testing.assert_allclose(both.w, np.concatenate([0.75 * places.w, 0.25 * faded.w]))


def test_time_moves_every_place():
    places = told([(0, 2.0)], 0.1)
    F = np.eye(4) + 2.0 * np.eye(4, k=2)
    moved = hy.predict(places, F, np.eye(4))
    np.testing.assert_allclose(moved.P[3], F @ places.P[3] @ F.T + np.eye(4))
    np.testing.assert_array_equal(moved.w, places.w)


def test_a_place_that_rounding_left_a_line_is_merged_along_it_alone():
    line = np.zeros((3, 4, 4))
    line[:, :2, :2], line[:, 2:, 2:] = [[4.0, 2.0], [2.0, 1.0]], np.eye(2)
    m = np.array([[0.0, 0.0, 0.0, 0.0], [1.0, 0.5, 0.0, 0.0], [1.0, -0.5, 0.0, 0.0]])
    left = hy.reduced(hy.Hypotheses(m, line, np.ones(3) / 3), 5)
    assert left.m[:, :2] == pytest.approx(np.array([[0.5, 0.25], [1.0, -0.5]]))
    assert left.w == pytest.approx([2 / 3, 1 / 3])
