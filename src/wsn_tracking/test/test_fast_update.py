"""The fast form of predict and update against the QR form, wherever it is trusted and wherever it is not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, beliefs, covariances, properties, seeds, some_silent

from wsn_tracking.filters import blocks, gram, qr, srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import regress
from wsn_tracking.filters.linalg import WRITTEN_OUT, matvec, transpose
from wsn_tracking.filters.robust import with_offsets
from wsn_tracking.filters.srckf import predict, update
from wsn_tracking.models.draws import Stream, keyed
from wsn_tracking.models.measurement import POSITION, constant_noise, rssi_function
from wsn_tracking.models.motion import constant_velocity

shapes = st.sampled_from([(), (1,), (3,), (2, 3), (WRITTEN_OUT,), (2, WRITTEN_OUT)])
kappas = st.sampled_from([0.0, 0.5, 2.0])
words = st.integers(0, 2**64 - 1)


def drawn(seed, shape, silent=0.5, std=0.15):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, *shape, position_std=std)
    belief = Belief(m, np.linalg.cholesky(P))
    truth = m + matvec(belief.chol_P, rng.standard_normal(m.shape))
    z = np.maximum(H(truth) * (1.0 + 0.12 * rng.standard_normal((*shape, 12))), 0.01)
    return belief, some_silent(rng, z, silent)


def equal(one, other, tolerance=1e-9):
    """In units of the standard deviations that the reference tells."""
    unit = np.sqrt(np.square(other.chol_P).sum(axis=-1))
    np.testing.assert_allclose((one.m - other.m) / unit, 0.0, atol=tolerance)
    np.testing.assert_allclose((one.chol_P - other.chol_P) / unit[..., None], 0.0, atol=tolerance)
    np.testing.assert_array_equal(one.chol_P, np.tril(one.chol_P))


# --- the same numbers


@properties
@given(seeds, shapes, st.sampled_from([1, 3]), kappas)
def test_fast_update_is_the_qr_update(seed, shape, passes, kappa):
    belief, z = drawn(seed, shape)
    exact = update(belief, z, H, NOISE, passes, kappa, form='qr')
    equal(update(belief, z, H, NOISE, passes, kappa), exact)
    equal(update(belief, z, H, NOISE, passes, kappa, seen=POSITION), exact)


@properties
@given(seeds, shapes, st.sampled_from([1, 3]), kappas)
def test_fast_update_is_the_qr_update_with_an_offset_a_link(seed, shape, passes, kappa):
    """h looks at the position, the last twelve states are added to what it reads."""
    rng = np.random.default_rng(seed)
    planar, _ = drawn(seed, shape)
    belief = with_offsets(planar, np.full(12, 4.0))
    h, noise = rssi_function(LOOP.anchors), constant_noise(np.full(12, 2.0))
    z = some_silent(rng, h(belief.m[..., None, :])[..., 0, :] + 4.0 * rng.standard_normal((*shape, 12)))
    exact = update(belief, z, h, noise, passes, kappa, offsets=12, form='qr')
    for seen in (None, POSITION):
        equal(update(belief, z, h, noise, passes, kappa, 12, seen), exact)


@properties
@given(seeds, shapes, st.floats(0.0, 3.0))
def test_fast_prediction_is_the_qr_prediction(seed, shape, dt):
    rng = np.random.default_rng(seed)
    belief, _ = drawn(seed, shape)
    chol_Q = np.linalg.cholesky(covariances(rng, *shape, condition=100.0))
    for F in (constant_velocity(dt), rng.standard_normal((4, 4))):
        equal(predict(belief, F, chol_Q), predict(belief, F, chol_Q, 'qr'))


@properties
@given(seeds, shapes, kappas)
def test_both_forms_drop_a_node_that_was_not_heard(seed, shape, kappa):
    belief, z = drawn(seed, shape, silent=0.0)
    z[..., 3:] = np.nan
    few = update(belief, z[..., :3], lambda x: H(x)[..., :3], lambda x: NOISE(x)[..., :3], 1, kappa)
    equal(update(belief, z, H, NOISE, 1, kappa), few, 1e-12)


@properties
@given(seeds, kappas)
def test_regression_over_what_h_looks_at_keeps_every_moment(seed, kappa):
    belief, _ = drawn(seed, (2,), std=0.5)
    whole = regress(H, belief, kappa)
    d = POSITION
    part = regress(H, Belief(belief.m[..., :d], belief.chol_P[..., :d, :d]), kappa + 4 - d)
    np.testing.assert_allclose(part.z_hat, whole.z_hat, atol=1e-12)
    np.testing.assert_allclose(part.O, whole.O[..., :d], atol=1e-12)
    np.testing.assert_allclose(whole.O[..., d:], 0.0, atol=1e-12)
    np.testing.assert_allclose(part.E @ transpose(part.E), whole.E @ transpose(whole.E), atol=1e-12)


@properties
@given(seeds, st.floats(1e-3, 100.0))
def test_even_part_is_that_of_the_unscented_points(seed, kappa):
    """Weighted sum over all 2n + 1 points, of which one is the mean."""
    belief, _ = drawn(seed, (), std=0.5)
    m, S = belief
    spread = np.sqrt(4 + kappa) * S.T
    Z = H(np.concatenate([m + spread, m - spread, m[None]]))
    w = np.append(np.full(8, 0.5), kappa) / (4 + kappa)
    r = regress(H, belief, kappa)
    assert r.E.shape == (12, 4)
    d = Z - w @ Z
    np.testing.assert_allclose(r.z_hat, w @ Z, rtol=1e-12)
    np.testing.assert_allclose(r.O @ r.O.T + r.E @ r.E.T, (w[:, None] * d).T @ d, atol=1e-11)


# --- where it must not be trusted


@properties
@given(seeds, shapes, st.floats(1e-12, 1e-7))
def test_near_singular_noise_falls_back_to_qr(seed, shape, std):
    """Readings so exact that two of them fix the position: the Gram matrix would lose half of all digits."""
    belief, z = drawn(seed, shape, silent=0.0)
    noise = constant_noise(np.full((*shape, 12), std))
    r = regress(H, belief)
    _, trusted = gram.condition(belief, z, np.isnan(z), r, np.full((*shape, 12), std))
    assert not trusted.all(axis=-1).any()
    exact = update(belief, z, H, noise, form='qr')
    fast = update(belief, z, H, noise)
    np.testing.assert_array_equal(fast.m, exact.m)
    np.testing.assert_array_equal(fast.chol_P, exact.chol_P)


@properties
@given(seeds, shapes)
def test_no_noise_at_all_falls_back_to_qr(seed, shape):
    belief, z = drawn(seed, shape, silent=0.8)
    exact = update(belief, z, H, constant_noise(np.zeros(12)), form='qr')
    fast = update(belief, z, H, constant_noise(np.zeros(12)))
    heard = ~np.isnan(z).all(axis=-1)
    np.testing.assert_array_equal(fast.m[heard], exact.m[heard])
    np.testing.assert_array_equal(fast.chol_P[heard], exact.chol_P[heard])


@pytest.mark.parametrize('shape', [(), (3,), (100,)])
@pytest.mark.parametrize('thin', [0.0, 1e-12, 1e-6])
def test_near_singular_prediction_falls_back_to_qr(shape, thin):
    """Position and velocity that are all but the same number, and no process noise."""
    S = np.zeros((*shape, 4, 4))
    S[..., :, 0] = [1.0, 1.0, 1.0, 1.0]
    S[..., range(1, 4), range(1, 4)] = thin
    belief = Belief(np.ones((*shape, 4)), S)
    F, none = constant_velocity(1.0), np.zeros((4, 4))
    assert not gram.predict(belief, F, none)[1].all(axis=-1).any()
    fast, exact = predict(belief, F, none), qr.predict(belief, F, none)
    np.testing.assert_array_equal(fast.chol_P, exact.chol_P)
    np.testing.assert_allclose(exact.P, F @ belief.P @ F.T, atol=1e-12)


@pytest.mark.parametrize('size', [3, 100])
def test_one_bad_filter_leaves_the_others_of_a_batch_as_they_are(size):
    belief, z = drawn(5, (size,), silent=0.3)
    std = np.full((size, 12), 0.1)
    std[1] = 1e-9
    mixed = update(belief, z, H, constant_noise(std))
    equal(mixed, update(belief, z, H, constant_noise(std), form='qr'))
    exact = update(Belief(belief.m[1], belief.chol_P[1]), z[1], H, constant_noise(std[1]), form='qr')
    np.testing.assert_allclose(mixed.m[1], exact.m, rtol=1e-9)


@properties
@given(seeds, st.floats(0.0, 8.0))
def test_no_reading_is_too_absurd_to_be_answered_as_qr_does(seed, exponent):
    belief, z = drawn(seed, ())
    absurd = z * 10.0**exponent
    exact = update(belief, absurd, H, constant_noise(np.full(12, 0.1)), form='qr')
    fast = update(belief, absurd, H, constant_noise(np.full(12, 0.1)))
    np.testing.assert_allclose(fast.m, exact.m, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(fast.chol_P, exact.chol_P, atol=1e-9)


def test_factor_is_lapacks_whatever_the_batch():
    rng = np.random.default_rng(3)
    A = covariances(rng, WRITTEN_OUT, n=6, condition=100.0)
    whole = np.linalg.cholesky(A)
    L, trusted = gram.cholesky(A, 4)
    assert trusted.shape == (WRITTEN_OUT, 4)
    assert trusted.all()
    np.testing.assert_allclose(L, whole[..., :4], atol=1e-12)
    np.testing.assert_allclose(gram.cholesky(A[:5], 4).L, whole[:5, :, :4], atol=1e-12)


@pytest.mark.parametrize('batch', [(), (3,), (WRITTEN_OUT,)])
def test_a_matrix_that_is_not_definite_has_no_factor_that_is_trusted(batch):
    A = np.broadcast_to(np.diag([1.0, -1.0, 1.0]), (*batch, 3, 3))
    assert not gram.cholesky(A, 3).trusted.all(axis=-1).any()


# --- blocks


@pytest.mark.parametrize('passes', [1, 3])
def test_blocks_of_a_large_batch_change_nothing(monkeypatch, passes):
    belief, z = drawn(6, (5, 40))
    share = np.full((5, 1, 12), 0.12)
    for module in (blocks, srckf):
        monkeypatch.setattr(module, 'BLOCK', 70)
    sizes = []

    def h(x):
        sizes.append(x.shape[0])
        return H(x)

    in_blocks = update(belief, z[:, :1], h, lambda x: share[..., None, :] * H(x), passes)
    assert set(sizes) == {66, 67}
    whole = update(belief, z[:, :1], H, lambda x: share[..., None, :] * H(x), passes, form='qr')
    assert in_blocks.m.shape == (5, 40, 4)
    equal(in_blocks, whole)


# --- draws


@properties
@given(words, words, st.lists(words, min_size=1, max_size=5))
def test_a_stream_draws_what_a_generator_of_its_own_would(seed, who, epochs):
    stream = Stream(seed, who)
    for epoch in (*epochs, *reversed(epochs)):
        ours, theirs = stream.at(epoch), keyed(seed, who, epoch)
        assert ours.uniform(6.0, 8.0) == theirs.uniform(6.0, 8.0)
        assert ours.random() == theirs.random()
        np.testing.assert_array_equal(ours.standard_normal(3), theirs.standard_normal(3))
        assert ours.integers(100) == theirs.integers(100)
