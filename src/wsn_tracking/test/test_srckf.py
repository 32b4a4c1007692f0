"""The square-root cubature filter is its covariance form, whoever is silent and however many run at once."""

import numpy as np
import pytest
from belief_cases import F, close, drawn, forms, heard
from hypothesis import given
from oracles import LOOP, NOISE, H, dense_ckf, dense_predict, properties, seeds, some_silent

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.srckf import FORMS, predict, update
from wsn_tracking.models.noise import scaled_identity, white_acceleration


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


def test_estimators_of_one_run_share_its_measurements():
    """z (runs, 1, N) against beliefs (runs, estimators, n), and a belief without batch against many z."""
    belief, z = drawn(5, 4, 3)
    shared = update(belief, z[:, :1], H, NOISE, 2)
    assert shared.m.shape == (4, 3, 4)
    one = update(Belief(belief.m[2, 1], belief.chol_P[2, 1]), z[2, 0], H, NOISE, 2)
    np.testing.assert_allclose(shared.m[2, 1], one.m, rtol=1e-12)
    many = update(Belief(belief.m[2, 1], belief.chol_P[2, 1]), z[:, 0], H, NOISE, 2)
    np.testing.assert_allclose(many.m[2], one.m, rtol=1e-12)
