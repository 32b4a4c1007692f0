"""The primitives of square-root filters: triangular roots, cubature points and regression by them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import H, beliefs, moments, properties, seeds

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import points, regress
from wsn_tracking.filters.linalg import every, gramian, matvec, product, solve, some, transpose, tria

matrices = st.tuples(st.integers(1, 6), st.integers(0, 6), st.sampled_from([(), (3,), (2, 2)]), seeds)


@properties
@given(matrices)
def test_tria_is_the_lower_root_of_the_square(drawn):
    n, extra, batch, seed = drawn
    A = np.random.default_rng(seed).standard_normal((*batch, n, n + extra)) * 10.0 ** np.arange(-3, n - 3)[:, None]
    L = tria(A)
    square = A @ transpose(A)
    unit = np.sqrt(np.diagonal(square, axis1=-2, axis2=-1))
    np.testing.assert_allclose(
        L @ transpose(L) / (unit[..., :, None] * unit[..., None, :]),
        square / (unit[..., :, None] * unit[..., None, :]),
        atol=1e-12,
    )
    np.testing.assert_array_equal(L, np.tril(L))
    assert np.all(np.diagonal(L, axis1=-2, axis2=-1) >= 0.0)
    Q = np.linalg.qr(np.random.default_rng(seed + 1).standard_normal((n + extra, n + extra)))[0]
    np.testing.assert_allclose(tria(A @ Q) / unit[..., :, None], L / unit[..., :, None], atol=1e-7)


def test_tria_of_a_singular_matrix_is_still_its_root():
    A = np.array([[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(tria(A) @ tria(A).T, A @ A.T, atol=1e-14)


def test_solve_and_matvec_are_each_others_inverse():
    rng = np.random.default_rng(2)
    L, b = tria(rng.standard_normal((5, 2, 4, 4))), rng.standard_normal((5, 2, 4))
    np.testing.assert_allclose(matvec(L, solve(L, b)), b, rtol=1e-9)


@pytest.mark.parametrize('left', [(), (3,), (2, 1)])
@pytest.mark.parametrize('right', [(), (3,), (2, 3)])
def test_products_are_the_sums_that_they_stand_for_whatever_the_batch(left, right):
    rng = np.random.default_rng(3)
    A, B, b = (rng.standard_normal(shape) for shape in ((*left, 4, 5), (*right, 5, 2), (*right, 5)))
    np.testing.assert_allclose(product(A, B), np.einsum('...ij,...jk->...ik', A, B), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(matvec(A, b), np.einsum('...ij,...j->...i', A, b), rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(gramian(A), np.einsum('...ij,...kj->...ik', A, A), rtol=0.0, atol=1e-13)


@pytest.mark.parametrize('shape', [(), (0,), (3,), (2, 3), (100, 4)])
def test_masks_are_asked_as_numpy_would(shape):
    full = np.ones(shape, dtype=np.bool_)
    for mask in (full, ~full, np.arange(full.size).reshape(shape) > 0):
        for view in (mask, mask.T, mask[::-1] if mask.ndim else mask):
            assert every(view) == view.all()
            assert some(view) == view.any()


@properties
@given(seeds)
def test_regression_keeps_every_moment_of_the_cubature_rule(seed):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, position_std=0.4)
    S = np.linalg.cholesky(P)
    r = regress(H, Belief(m, S))
    z_hat, P_zz, P_xz = moments(m, P, H)
    np.testing.assert_allclose(r.z_hat, z_hat, rtol=1e-12)
    np.testing.assert_allclose(r.O @ r.O.T + r.E @ r.E.T, P_zz, atol=1e-12)
    np.testing.assert_allclose(S @ r.O.T, P_xz, atol=1e-12)


@properties
@given(seeds)
def test_regression_of_a_linear_function_has_no_error(seed):
    rng = np.random.default_rng(seed)
    A, b, S = rng.standard_normal((5, 4)), rng.standard_normal(5), tria(rng.standard_normal((3, 4, 4)))
    m = rng.standard_normal((3, 4))
    r = regress(lambda x: x @ A.T + b, Belief(m, S))
    np.testing.assert_allclose(r.z_hat, m @ A.T + b, atol=1e-12)
    np.testing.assert_allclose(r.O, A @ S, atol=1e-12)
    np.testing.assert_allclose(r.E, 0.0, atol=1e-12)


@properties
@given(seeds)
def test_cubature_points_have_the_beliefs_mean_and_covariance(seed):
    m, P = beliefs(np.random.default_rng(seed), 3)
    X = points(Belief(m, np.linalg.cholesky(P)))
    assert X.shape == (3, 8, 4)
    d = X - m[:, None]
    np.testing.assert_allclose(X.mean(axis=-2), m, atol=1e-12)
    np.testing.assert_allclose(transpose(d) @ d / 8.0, P, atol=1e-12)
