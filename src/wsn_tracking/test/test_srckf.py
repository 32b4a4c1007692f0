"""Algorithm 1 of seed 000 against its covariance form, Stone Soup, and what must hold of any filter."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import (
    LOOP,
    NOISE,
    H,
    at_least,
    beliefs,
    covariances,
    dense_ckf,
    dense_iplf,
    dense_predict,
    kalman,
    moments,
    properties,
    some_silent,
)

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import points, regress
from wsn_tracking.filters.linalg import matvec, solve, transpose, tria
from wsn_tracking.filters.srckf import FORMS, predict, update
from wsn_tracking.models.measurement import constant_noise, range_function, relative_noise
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import scaled_identity, white_acceleration

seeds = st.integers(0, 2**32 - 1)
forms = st.sampled_from(FORMS)
F = constant_velocity(1.0)


def drawn(seed, *shape, silent=0.5, noise=0.12, **options):
    """Beliefs, and what the nodes would tell of a state that is drawn from each."""
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, *shape, **options)
    belief = Belief(m, np.linalg.cholesky(P))
    truth = m + matvec(belief.chol_P, rng.standard_normal(m.shape))
    z = np.maximum(H(truth) * (1.0 + noise * rng.standard_normal((*shape, 12))), 0.01)
    return belief, some_silent(rng, z, silent)


def heard(z):
    """What the oracles, which know no silence, may look at: the functions of the nodes that were heard."""
    rows = np.flatnonzero(~np.isnan(z))
    return z[rows], lambda x: H(x)[..., rows], lambda x: NOISE(x)[..., rows]


def close(belief, m, P, rtol):
    """Relative to the size of the covariance: that is the unit in which an estimate may be off."""
    unit = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    np.testing.assert_allclose((belief.m - m) / unit, 0.0, atol=rtol)
    np.testing.assert_allclose((belief.P - P) / (unit[..., :, None] * unit[..., None, :]), 0.0, atol=rtol)


# --- Shows (1): the square-root form is the covariance form


@pytest.mark.parametrize('form', FORMS)
@pytest.mark.parametrize('root_Q', [scaled_identity(7.0), white_acceleration(1.6e-3, 1.0)], ids=['identity', 'cwna'])
def test_square_root_form_equals_covariance_form_over_100_steps(root_Q, form):
    rng = np.random.default_rng(11)
    belief = Belief(LOOP.truth[0] + 0.05, np.diag([0.1, 0.1, 0.06, 0.06]))
    m, P = belief.m, belief.P
    for k in range(1, 101):
        z = some_silent(rng, H(LOOP.truth[k]) * (1.0 + 0.12 * rng.standard_normal(12)), 0.6)
        q = rng.uniform(0.8, 1.2)
        belief = update(predict(belief, F, q * root_Q, form), z, H, NOISE, form=form)
        m, P = dense_predict(m, P, F, q * q * root_Q @ root_Q.T)
        some, h, noise = heard(z)
        if some.size:
            m, P = dense_ckf(m, P, some, h, np.diag(noise(m[None])[0] ** 2))
        np.testing.assert_allclose(belief.m, m, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(belief.P, P, rtol=0.0, atol=1e-9)
    assert np.hypot(*(belief.m - LOOP.truth[100])[:2]) < 0.5


@properties
@given(seeds, forms)
def test_masked_rows_equal_removed_rows(seed, form):
    belief, z = drawn(seed)
    some, h, noise = heard(z)
    for passes in (1, 3):
        removed = update(belief, some, h, noise, passes, form=form)
        close(update(belief, z, H, NOISE, passes, form=form), removed.m, removed.P, 1e-9)


@properties
@given(seeds)
def test_an_unheard_nodes_noise_may_be_unknown(seed):
    """The noise of a silent node is NaN where it is told by its range."""
    belief, z = drawn(seed)
    share = np.where(np.isnan(z), np.nan, 0.12)
    both = [update(belief, z, H, noise) for noise in (lambda x: share * H(x), lambda x: 0.12 * H(x))]
    np.testing.assert_array_equal(both[0].m, both[1].m)
    np.testing.assert_array_equal(both[0].chol_P, both[1].chol_P)


@pytest.mark.parametrize('form', FORMS)
@pytest.mark.parametrize('passes', [1, 3])
def test_an_empty_epoch_is_the_prediction(passes, form):
    belief, z = drawn(3, 20)
    after = update(belief, np.full(z.shape, np.nan), H, NOISE, passes, form=form)
    np.testing.assert_array_equal(after.m, belief.m)
    np.testing.assert_allclose(after.chol_P, belief.chol_P, rtol=1e-12, atol=1e-16)


@pytest.mark.parametrize('form', FORMS)
@pytest.mark.parametrize('passes', [1, 3])
def test_a_batch_equals_its_runs_one_by_one(passes, form):
    belief, z = drawn(4, 30, 3)
    Q = scaled_identity(np.random.default_rng(0).uniform(2.0, 12.0, (30, 3)))
    batch = update(predict(belief, F, Q, form), z, H, NOISE, passes, form=form)
    for i in np.ndindex(30, 3):
        one = predict(Belief(belief.m[i], belief.chol_P[i]), F, Q[i], form)
        one = update(one, z[i], H, NOISE, passes, form=form)
        np.testing.assert_allclose(batch.m[i], one.m, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(batch.chol_P[i], one.chol_P, rtol=1e-9, atol=1e-12)


# --- the two forms


@properties
@given(seeds, st.floats(-9.0, 3.0), st.floats(-6.0, 2.0), st.sampled_from([(), (3,), (80,)]))
def test_both_forms_agree_also_where_one_of_them_is_near_singular(seed, noise, spread, batch):
    """Noise roots from 1e-9 to 1e3 times the usual ones, beliefs from micrometres to a hundred metres wide."""
    wide = 10.0**spread
    belief, z = drawn(seed, *batch, noise=0.12 * 10.0**noise, position_std=wide, velocity_std=wide)

    def scaled(x):
        return 10.0**noise * NOISE(x)

    exact, other = (update(belief, z, H, scaled, form=form) for form in ('qr', 'gram'))
    close(other, exact.m, exact.P, 1e-3)


@properties
@given(seeds, st.floats(-3.0, 3.0), st.floats(-3.0, 1.0), st.integers(2, 5))
def test_both_forms_iterate_alike(seed, noise, spread, passes):
    belief, z = drawn(seed, 3, noise=0.12 * 10.0**noise, position_std=10.0**spread)

    def scaled(x):
        return 10.0**noise * NOISE(x)

    exact, other = (update(belief, z, H, scaled, passes, form=form) for form in ('qr', 'gram'))
    close(other, exact.m, exact.P, 1e-5)


@properties
@given(seeds, st.floats(-12.0, 0.0))
def test_both_forms_of_the_prediction_agree_also_for_singular_noise(seed, exponent):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, 70)
    belief = Belief(m, np.linalg.cholesky(P))
    scale = 10.0**exponent
    for A, root in (
        (F, scale * np.eye(4)),
        (scale * F, np.zeros((4, 4))),
        (np.zeros((4, 4)), scale * np.diag([1, 1, 0, 0])),
    ):
        one, other = predict(belief, A, root, 'gram'), predict(belief, A, root, 'qr')
        np.testing.assert_array_equal(one.m, other.m)
        size = np.abs(other.P).max()
        np.testing.assert_allclose(one.P / size, other.P / size, atol=1e-10)
        assert np.all(np.isfinite(one.chol_P))


@properties
@given(seeds, st.integers(1, 3), st.sampled_from([0.0, 1.5]))
def test_regressing_over_the_states_that_are_seen_changes_nothing(seed, passes, kappa):
    belief, z = drawn(seed, 3)
    for form in FORMS:
        whole = update(belief, z, H, NOISE, passes, kappa, form=form)
        seen = update(belief, z, H, NOISE, passes, kappa, seen=2, form=form)
        close(seen, whole.m, whole.P, 1e-8)


def test_estimators_of_one_run_share_its_measurements():
    """z (runs, 1, N) against beliefs (runs, estimators, n), and a belief without batch against many z."""
    belief, z = drawn(5, 4, 3)
    shared = update(belief, z[:, :1], H, NOISE, 2)
    assert shared.m.shape == (4, 3, 4)
    one = update(Belief(belief.m[2, 1], belief.chol_P[2, 1]), z[2, 0], H, NOISE, 2)
    np.testing.assert_allclose(shared.m[2, 1], one.m, rtol=1e-12)
    many = update(Belief(belief.m[2, 1], belief.chol_P[2, 1]), z[:, 0], H, NOISE, 2)
    np.testing.assert_allclose(many.m[2], one.m, rtol=1e-12)


# --- against others


@properties
@given(seeds, st.integers(1, 4), forms)
def test_iplf_is_the_textbooks(seed, passes, form):
    belief, z = drawn(seed, silent=0.4)
    some, h, noise = heard(z)
    m, P = dense_iplf(belief.m, belief.P, some, h, noise, passes)
    close(update(belief, z, H, NOISE, passes, form=form), m, P, 1e-7)


@properties
@given(seeds)
def test_iplf_of_one_pass_is_the_ckf(seed):
    belief, z = drawn(seed)
    some, h, noise = heard(z)
    m, P = dense_ckf(belief.m, belief.P, some, h, np.diag(noise(belief.m[None])[0] ** 2))
    close(update(belief, z, H, NOISE, 1), m, P, 1e-9)


@properties
@given(seeds, st.integers(1, 5))
def test_every_pass_on_a_linear_measurement_is_the_kalman_update(seed, passes):
    rng = np.random.default_rng(seed)
    A, b = rng.standard_normal((6, 4)), rng.standard_normal(6)
    P, std, m = covariances(rng), rng.uniform(0.1, 2.0, 6), rng.standard_normal(4)
    z = rng.standard_normal(6)
    after = update(Belief(m, np.linalg.cholesky(P)), z, lambda x: x @ A.T + b, constant_noise(std), passes)
    close(after, *kalman(m, P, z - b, A, np.diag(std**2)), 1e-8)


def test_stone_soups_cubature_filter_agrees():
    """In the same order of states: another order has other cubature points, and a result that is 1e-5 m away."""
    pytest.importorskip('stonesoup')
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.kalman import CubatureKalmanPredictor
    from stonesoup.types.array import StateVector, StateVectors
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import CubatureKalmanUpdater

    class Ranges(NonLinearGaussianMeasurement):
        """Distances to the nodes that were heard; Stone Soup's states are columns."""

        @property
        def ndim_meas(self):
            return len(self.covar())

        def function(self, state, noise=False, **kwargs):
            columns = H(np.asarray(state.state_vector, dtype=float).T)[..., nodes].T
            return (StateVector if columns.shape[-1] == 1 else StateVectors)(columns)

    rng, clock, root_Q = np.random.default_rng(8), datetime(2026, 1, 1), white_acceleration(1.6e-3, 1.0)  # noqa: DTZ001
    motion = LinearGaussianTimeInvariantTransitionModel(transition_matrix=F, covariance_matrix=root_Q @ root_Q.T)
    belief = Belief(LOOP.truth[0] + 0.05, np.diag([0.1, 0.1, 0.06, 0.06]))
    peer = GaussianState(belief.m, belief.P, timestamp=clock)
    for k in range(1, 31):
        nodes = np.sort(rng.permutation(12)[:5])
        z = np.full(12, np.nan)
        z[nodes] = H(LOOP.truth[k])[nodes] * (1.0 + 0.12 * rng.standard_normal(5))
        belief = update(predict(belief, F, root_Q), z, H, constant_noise(0.12 * z))
        model = Ranges(ndim_state=4, mapping=(0, 1), noise_covar=np.diag((0.12 * z[nodes]) ** 2))
        prediction = CubatureKalmanPredictor(motion).predict(peer, timestamp=clock + timedelta(seconds=k))
        detection = Detection(StateVector(z[nodes]), timestamp=prediction.timestamp, measurement_model=model)
        peer = CubatureKalmanUpdater(model).update(SingleHypothesis(prediction, detection))
        np.testing.assert_allclose(belief.m, np.ravel(peer.state_vector).astype(float), rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(belief.P, peer.covar, rtol=0.0, atol=1e-10)


# --- what holds of any update


@properties
@given(seeds, st.sampled_from([1, 2, 3, 10]), forms)
def test_an_update_never_knows_less_than_before(seed, passes, form):
    belief, z = drawn(seed, 4, silent=0.3, position_std=0.5)
    after = update(belief, z, H, NOISE, passes, form=form)
    assert np.all(np.isfinite(after.m))
    assert np.all(np.diagonal(after.chol_P, axis1=-2, axis2=-1) > 0.0)
    np.testing.assert_array_equal(after.chol_P, np.tril(after.chol_P))
    assert at_least(belief.P, after.P)


def test_a_target_on_top_of_a_node_is_no_number_that_breaks_the_filter():
    at_node = np.concatenate([LOOP.anchors.positions[5, :2], [0.0, 0.0]])
    z = np.full(12, np.nan)
    z[5] = 0.01
    for std in (1e-4, 1e-2, 1.0):
        for passes in (1, 3):
            after = update(Belief(at_node, std * np.eye(4)), z, H, NOISE, passes)
            assert np.all(np.isfinite(after.m))
            assert np.all(np.diagonal(after.chol_P) > 0.0)


@properties
@given(seeds, st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_a_filter_does_not_care_where_the_origin_is(seed, x, y):
    belief, z = drawn(seed)
    moved = LOOP.anchors._replace(positions=LOOP.anchors.positions + np.array([x, y, 0.0]))
    h = range_function(moved)
    shift = np.array([x, y, 0.0, 0.0])
    there = update(Belief(belief.m + shift, belief.chol_P), z, h, relative_noise(moved, h), 3)
    here = update(belief, z, H, NOISE, 3)
    np.testing.assert_allclose(there.m - shift, here.m, atol=1e-8)
    np.testing.assert_allclose(there.P, here.P, atol=1e-8)


@properties
@given(seeds)
def test_prediction_is_the_linear_time_update(seed):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, 2, 3)
    A, root_Q = rng.standard_normal((4, 4)), rng.standard_normal((3, 4, 4))
    after = predict(Belief(m, np.linalg.cholesky(P)), A, root_Q)
    np.testing.assert_allclose(after.m, m @ A.T, rtol=1e-10, atol=1e-12)
    fanned = predict(Belief(m[0, 0], np.linalg.cholesky(P[0, 0])), A, root_Q)
    assert (fanned.m.shape, fanned.chol_P.shape) == ((3, 4), (3, 4, 4))
    np.testing.assert_allclose(after.P, A @ P @ A.T + root_Q @ transpose(root_Q), rtol=1e-9, atol=1e-10)


# --- the primitives


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
