"""Linearised least squares of ranges, its low pass, and the ranges that agree with each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.filters import recent
from wsn_tracking.filters.agreement import MOST, Told, agreed
from wsn_tracking.filters.least_squares import least_squares

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]])
places = st.floats(-50.0, 50.0)


def ranges(a, x):
    return np.linalg.norm(np.asarray(x)[..., None, :] - a, axis=-1)


@properties
@given(st.integers(3, 9), st.integers(0, 2**32 - 1), places, places, st.floats(0.0, 1e5))
def test_it_is_exact_without_noise_wherever_the_nodes_and_the_target_are(N, seed, x, y, far):
    rng = np.random.default_rng(seed)
    a = rng.uniform(-10.0, 10.0, (N, 2)) + far
    found = least_squares(a, ranges(a, [x + far, y + far]))
    spread = np.linalg.svd(a - a.mean(axis=0), compute_uv=False)
    if spread[1] ** 2 > 0.02 * np.sum(spread**2):
        # the squares of distances cost digits where the target is far from the nodes, the coordinates theirs
        np.testing.assert_allclose(found, [x + far, y + far], rtol=0.0, atol=1e-9 + 1e-9 * far)


@properties
@given(st.integers(0, 2**32 - 1), st.floats(0.0, np.pi), st.integers(3, 6))
def test_nodes_on_a_line_or_fewer_than_three_tell_no_place(seed, angle, N):
    rng = np.random.default_rng(seed)
    a = np.array([3.0, -1.0]) + rng.uniform(-5.0, 5.0, (N, 1)) * [np.cos(angle), np.sin(angle)]
    assert np.isnan(least_squares(a, ranges(a, [1.0, 2.0]))).all()
    d = ranges(SQUARE, [0.5, 0.7])
    d[:2] = np.nan
    assert np.isnan(least_squares(SQUARE, d)).all()
    assert np.isnan(least_squares(SQUARE, np.full(4, np.nan))).all()


def test_missing_ranges_are_rows_that_are_not_there_in_every_element_of_a_batch():
    rng = np.random.default_rng(1)
    a = rng.uniform(0.0, 5.0, (6, 2))
    d = ranges(a, rng.uniform(0.0, 5.0, (20, 3, 2))) + 0.1 * rng.standard_normal((20, 3, 6))
    d[rng.random(d.shape) < 0.3] = np.nan
    whole = least_squares(a, d)
    for i in np.ndindex(20, 3):
        kept = ~np.isnan(d[i])
        np.testing.assert_allclose(whole[i], least_squares(a[kept], d[i][kept]), atol=1e-9)


def test_it_solves_the_documents_equations():
    """A_j = 2 (a_j - a_n), B_j = |a_j|^2 - |a_n|^2 - d_j^2 + d_n^2, by another solver."""
    rng = np.random.default_rng(2)
    a = rng.uniform(0.0, 5.0, (5, 2))
    d = ranges(a, [1.0, 2.0]) + 0.1 * rng.standard_normal(5)
    s = np.sum(a**2, axis=1)
    A, B = 2.0 * (a[:-1] - a[-1]), s[:-1] - s[-1] - d[:-1] ** 2 + d[-1] ** 2
    np.testing.assert_allclose(least_squares(a, d), np.linalg.lstsq(A, B, rcond=None)[0], atol=1e-9)


def test_weights_are_generalised_least_squares_of_the_differences():
    """cov(d_j^2 - d_n^2) = diag(v_j) + v_n: the common error of node n, dense."""
    rng = np.random.default_rng(3)
    a = rng.uniform(0.0, 5.0, (6, 2))
    d = ranges(a, [4.0, 1.0]) + 0.2 * rng.standard_normal(6)
    v = rng.uniform(0.1, 3.0, 6)
    s = np.sum(a**2, axis=1)
    A, B = 2.0 * (a[:-1] - a[-1]), s[:-1] - s[-1] - d[:-1] ** 2 + d[-1] ** 2
    W = np.linalg.inv(np.diag(v[:-1]) + v[-1])
    expected = np.linalg.solve(A.T @ W @ A, A.T @ W @ B)
    np.testing.assert_allclose(least_squares(a, d, 1.0 / v), expected, atol=1e-9)
    assert np.isnan(least_squares(a, np.full(6, np.nan), 1.0 / v)).all()


# --- the latest range of each node


def told_of(d, t, weights=1.0):
    told = recent.nothing((), 4)
    for row in range(4):
        told = recent.hear(told, np.asarray(row), np.asarray(d[row]), np.asarray(weights), t[row])
    return told


def test_only_the_latest_range_of_a_node_counts_and_only_while_it_is_young():
    d = ranges(SQUARE, [0.5, 0.7])
    told = told_of(d, [0.0, 0.1, 0.2, 0.3])
    np.testing.assert_allclose(recent.solve(told, SQUARE, 0.3, 0.3), [0.5, 0.7], atol=1e-12)
    np.testing.assert_allclose(recent.solve(told, SQUARE, 0.4, 0.3), [0.5, 0.7], atol=1e-12)
    assert np.isnan(recent.solve(told, SQUARE, 0.5, 0.3)).all()
    lost = recent.hear(told, np.asarray(1), np.asarray(np.nan), np.asarray(1.0), 0.35)
    np.testing.assert_array_equal(lost.d, told.d)
    moved = recent.hear(told, np.asarray(1), np.asarray(9.0), np.asarray(1.0), 0.35)
    assert moved.d[1] == 9.0
    assert moved.t[1] == 0.35


def test_the_low_pass_follows_at_the_documents_weights_and_begins_anew_after_a_gap():
    told = recent.nothing((), 4)
    first, second = np.array([1.0, 1.0]), np.array([2.0, 1.0])
    told = recent.follow(told, first, 0.0, 0.35)
    np.testing.assert_allclose(told.x, [1.0, 1.0, 0.0, 0.0])
    told = recent.follow(told, second, 0.1, 0.35)
    np.testing.assert_allclose(told.x, [1.5, 1.0, 0.3 * 0.5 / 0.1, 0.0])
    silent = recent.follow(told, np.full(2, np.nan), 0.2, 0.35)
    np.testing.assert_allclose(silent.x, told.x)
    assert np.isnan(silent.since)
    again = recent.follow(silent, second, 0.3, 0.35)
    np.testing.assert_allclose(again.x, [1.75, 1.0, 0.7 * 1.5 + 0.3 * 0.25 / 0.2, 0.0])
    assert again.since == 0.3
    anew = recent.follow(again, first, 0.8, 0.35)
    np.testing.assert_allclose(anew.x, [1.0, 1.0, 0.0, 0.0])


def test_the_same_instant_twice_leaves_the_velocity():
    told = recent.follow(recent.nothing((), 4), np.zeros(2), 0.0, 1.0)
    told = recent.follow(told, np.array([1.0, 0.0]), 0.0, 1.0)
    np.testing.assert_allclose(told.x, [0.5, 0.0, 0.0, 0.0])


def test_a_misfit_is_what_motion_since_a_range_does_not_explain():
    d = ranges(SQUARE, [0.5, 0.7])
    d[2] += 0.5
    told = told_of(d, [0.0, 0.1, 0.2, 0.3])
    assert recent.misfit(told, SQUARE, np.array([0.5, 0.7]), 0.3, 1.0, 0.0) == pytest.approx(0.5)
    assert recent.misfit(told, SQUARE, np.array([0.5, 0.7]), 0.3, 1.0, 2.0) == pytest.approx(0.3)
    assert recent.misfit(told, SQUARE, np.array([0.5, 0.7]), 0.3, 0.05, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(recent.misfit(told, SQUARE, np.full(2, np.nan), 0.3, 1.0, 0.0))


# --- the ranges that agree


def mixed(share, count, seed):
    """Ranges of a target at (1.2, 0.4) and, a share of them, of another at (3.1, 5.6), in any order."""
    rng = np.random.default_rng(seed)
    a = np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 2.0], [2.0, 2.0], [4.0, 2.0], [2.0, 4.0]])[
        rng.integers(0, 7, count)
    ]
    other = rng.permutation(count) < round(share * count)
    x = np.where(other[:, None], [3.1, 5.6], [1.2, 0.4])
    d = np.linalg.norm(x - a, axis=-1) + 0.02 * rng.standard_normal(count)
    return Told(a, d, np.full(count, 0.1))


def test_a_minority_of_ranges_of_another_target_does_not_move_the_place():
    found = [agreed(mixed(0.3, 12, seed), 5, 0.6) for seed in range(40)]
    kept = [x for x in found if x is not None]
    assert len(kept) >= 35
    assert max(np.linalg.norm(x - [1.2, 0.4]) for x in kept) < 0.1  # of a few ranges with 2 cm each


def test_where_no_majority_agrees_there_is_no_place():
    assert all(agreed(mixed(0.5, 12, seed), 5, 0.75) is None for seed in range(20))
    assert agreed(mixed(0.0, 4, 1), 5, 0.6) is None
    line = Told(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]), np.full(4, 2.0), np.full(4, 9.0))
    assert agreed(line, 3, 0.6) is None


def test_the_latest_ranges_are_looked_at():
    old, new = mixed(1.0, 30, 1), mixed(0.0, MOST, 2)
    both = Told(*(np.concatenate(columns) for columns in zip(old, new, strict=True)))
    np.testing.assert_allclose(agreed(both, 5, 0.6), [1.2, 0.4], atol=0.1)
