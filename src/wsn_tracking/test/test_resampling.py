"""Resampling: unbiased, no more scattered than its kind allows, and never a particle that cannot be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.filters.resampling import RESAMPLERS, residual, stratified, systematic

KINDS = pytest.mark.parametrize('kind', sorted(RESAMPLERS))
W = np.array([0.31, 0.0, 0.004, 0.2, 0.066, 0.12, 0.3, 0.0])


def copies(indices, P):
    return np.apply_along_axis(np.bincount, -1, indices, minlength=P)


@KINDS
@pytest.mark.parametrize('n', [8, 5, 20])
def test_copies_are_unbiased(kind, n):
    """Of 40 000 draws; multinomial copies scatter most, by n w (1 - w)."""
    runs = 40_000
    counts = copies(RESAMPLERS[kind](np.tile(W, (runs, 1)), n, np.random.default_rng(1)), W.size)
    assert np.all(counts.sum(axis=-1) == n)
    error = np.sqrt(n * W * (1.0 - W) / runs)
    assert np.all(np.abs(counts.mean(axis=0) - n * W) <= 5.0 * error)


def variance(kind, w, n, runs=20_000):
    return copies(RESAMPLERS[kind](np.tile(w, (runs, 1)), n, np.random.default_rng(2)), w.size).var(axis=0).sum()


def test_the_careful_kinds_scatter_less():
    """Douc, Cappe and Moulines prove it of stratified and residual; systematic is usual, and so for these weights."""
    independent = variance('multinomial', W, 8)
    assert independent == pytest.approx(8 * np.sum(W * (1.0 - W)), rel=0.03)
    for kind in ('stratified', 'residual', 'systematic'):
        assert variance(kind, W, 8) < 0.6 * independent


weights = st.lists(st.one_of(st.just(0.0), st.floats(1e-12, 1.0)), min_size=1, max_size=40).filter(any)


@KINDS
@properties
@given(w=weights, n=st.integers(1, 60), seed=st.integers(0, 1000), runs=st.integers(0, 3))
def test_indices_ascend_and_a_particle_without_weight_is_never_drawn(kind, w, n, seed, runs):
    w = np.array(w) / np.sum(w)
    batch = np.tile(w, (runs, 1)) if runs else w
    indices = RESAMPLERS[kind](batch, n, np.random.default_rng(seed))
    assert indices.shape == (*batch.shape[:-1], n)
    assert indices.min(initial=0) >= 0
    assert np.all(np.diff(indices, axis=-1) >= 0)
    assert np.all(w[indices] > 0.0)


@properties
@given(w=weights, n=st.integers(1, 60), seed=st.integers(0, 1000))
def test_systematic_copies_are_within_one_of_what_is_due(w, n, seed):
    w = np.array(w) / np.sum(w)
    off = copies(systematic(w, n, np.random.default_rng(seed)), w.size) - n * w
    assert np.all(np.abs(off) < 1.0 + 1e-9)
    off = copies(stratified(w, n, np.random.default_rng(seed)), w.size) - n * w
    assert np.all(np.abs(off) < 2.0 + 1e-9)


@properties
@given(w=weights, n=st.integers(1, 60), seed=st.integers(0, 1000))
def test_residual_copies_hold_what_is_certain(w, n, seed):
    w = np.array(w) / np.sum(w)
    assert np.all(copies(residual(w, n, np.random.default_rng(seed)), w.size) >= np.floor(n * w))


@KINDS
def test_equal_weights_of_equal_number_are_all_kept_by_the_careful_kinds(kind):
    indices = RESAMPLERS[kind](np.full(64, 1.0 / 64.0), 64, np.random.default_rng(3))
    if kind == 'multinomial':
        assert np.unique(indices).size < 64
    else:
        np.testing.assert_array_equal(indices, np.arange(64))


@KINDS
def test_rows_of_a_batch_are_drawn_by_their_own_weights(kind):
    rng = np.random.default_rng(4)
    w = rng.dirichlet(np.full(30, 0.3), (6, 50))
    indices = RESAMPLERS[kind](w, 300, rng)
    counts = copies(indices, 30)
    assert np.all(np.abs(counts - 300 * w) < 6.0 * np.sqrt(300 * w) + 3.0)


@KINDS
def test_many_rows_do_not_run_into_each_other(kind):
    """The last particle of a row beside the first of the next, where places are within rounding of the border."""
    w = np.zeros((5000, 3))
    w[:, 0] = 1.0
    w[1::2] = [0.0, 0.0, 1.0]
    indices = RESAMPLERS[kind](w, 4, np.random.default_rng(5))
    assert np.all(indices[::2] == 0)
    assert np.all(indices[1::2] == 2)


class LastDraw:
    """A generator that draws nothing but the last number before one."""

    def random(self, shape):
        return np.full(shape, 1.0 - 2.0**-53)


@pytest.mark.parametrize('kind', ['systematic', 'stratified'])
@pytest.mark.parametrize('shape', [(500,), (3, 500)])
def test_a_draw_that_is_rounded_to_one_is_of_the_last_particle(kind, shape):
    drawn = RESAMPLERS[kind](np.full(shape, 1.0 / 500), 500, LastDraw())
    assert np.all(drawn[..., -1] == 499)
