"""What one node's range and bearing contribute, against the covariance form and the printed formulas."""

import numpy as np
import pytest
from consensus_cases import R, dense_contribution, dense_moments, density, turned
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties, seeds

from wsn_tracking.filters import information
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.information import (
    Information,
    contribute,
    is_definite,
    packed,
    to_belief,
    to_information,
    unpacked,
)
from wsn_tracking.filters.triangular import forward, inverse
from wsn_tracking.models.range_bearing import innovation, range_bearing_function, wrapped

LOSS = {'uniform': information.uniform(600.0), 'zero': information.zero, 'absent': information.absent}


def drawn(seed, *shape):
    """Beliefs of a target some 20 to 400 m from its node, and readings of a state drawn from each."""
    rng = np.random.default_rng(seed)
    m = np.concatenate([rng.uniform(0.0, 350.0, (*shape, 2)), rng.normal(0.0, 10.0, (*shape, 2))], axis=-1)
    A = rng.standard_normal((*shape, 4, 6)) * [[3.0], [3.0], [1.0], [1.0]]
    S = np.linalg.cholesky(A @ np.swapaxes(A, -1, -2))
    angle, d = rng.uniform(-np.pi, np.pi, shape), rng.uniform(20.0, 400.0, shape)
    at = m[..., :2] + d[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    positions = np.concatenate([at, np.zeros((*shape, 1))], axis=-1)
    x = m + (S @ rng.standard_normal((*shape, 4, 1)))[..., 0]
    z = range_bearing_function(positions, m)(x[..., None, :])[..., 0, :] + rng.normal(0.0, [0.1, 0.5], (*shape, 2))
    z[..., 1] = wrapped(z[..., 1])
    return Belief(m, S), positions, z


def own(belief, positions, z, pi_1=0.9, loss='uniform', omega_weight=1.0, noise=R):
    h = range_bearing_function(positions, belief.m)
    pi_1 = np.broadcast_to(pi_1, belief.m.shape[:-1])
    return contribute(belief, h, z, noise, pi_1, LOSS[loss], omega_weight)


@properties
@given(seeds, st.sampled_from(sorted(LOSS)), st.sampled_from([0.0, 1.0, 4.0]), st.floats(0.01, 0.99))
def test_a_contribution_is_the_documents(seed, loss, omega_weight, pi_1):
    belief, position, z = drawn(seed)
    (i, I), mu = own(belief, position, z, pi_1, loss, omega_weight)
    dense_i, dense_I, dense_mu = dense_contribution(belief.m, belief.P, position, z, pi_1, loss, omega_weight)
    assert mu == pytest.approx(dense_mu, rel=1e-6, abs=1e-12)
    scale = np.abs(dense_I).max() + 1e-12
    assert pytest.approx(dense_I, rel=1e-6, abs=1e-9 * scale) == I
    assert i == pytest.approx(dense_i, rel=1e-6, abs=1e-7 * scale * np.abs(belief.m).max())


@properties
@given(seeds)
def test_with_its_linearisation_error_it_is_the_cubature_kalman_update(seed):
    belief, position, z = drawn(seed)
    prior = to_information(belief)
    (i, I), mu = own(belief, position, z, loss='absent')
    assert mu == 1.0
    after = to_belief(Information(prior.vector + i, prior.matrix + I))
    z_hat, P_zz, P_xz = dense_moments(belief.m, belief.P, position)
    v, S = z - z_hat, P_zz + R
    v[1] = turned(v[1])
    K = P_xz @ np.linalg.inv(S)
    assert after.m == pytest.approx(belief.m + K @ v, abs=1e-7)
    assert pytest.approx(belief.P - K @ S @ K.T, abs=1e-7) == after.P


@properties
@given(seeds)
def test_a_missing_bearing_leaves_a_range_update(seed):
    belief, position, z = drawn(seed)
    (i, I), mu = own(belief, position, np.array([z[0], np.nan]))
    z_hat, P_zz, P_xz = dense_moments(belief.m, belief.P, position)
    h = np.linalg.solve(belief.P, P_xz[:, 0])
    v, noise = z[0] - z_hat[0], R[0, 0] + P_zz[0, 0] - h @ belief.P @ h
    l1 = density(np.array([v]), np.array([[P_zz[0, 0] + R[0, 0]]]))
    expected = 1.0 / (1.0 + np.exp(-np.log(600.0) - l1 + np.log(0.1 / 0.9)))
    assert mu == pytest.approx(expected, rel=1e-6)
    assert pytest.approx(mu * np.outer(h, h) / noise, rel=1e-6, abs=1e-9) == I
    assert i == pytest.approx(mu * h * (v + h @ belief.m) / noise, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize('loss', sorted(LOSS))
def test_nothing_read_contributes_exactly_nothing(loss):
    belief, positions, z = drawn(1, 5)
    z[1:3] = np.nan
    (i, I), mu = own(belief, positions, z, loss=loss)
    assert not i[1:3].any()
    assert not I[1:3].any()
    assert mu[1:3].tolist() == [0.0, 0.0]
    assert np.all(np.isfinite(i))
    assert np.all(mu[[0, 3, 4]] > 0.0)


def test_a_negligible_weight_contributes_exactly_nothing():
    belief, position, z = drawn(2)
    (i, I), mu = own(belief, position, z + np.array([150.0, 0.0]))
    assert 0.0 <= mu < 1e-8
    assert not i.any()
    assert not I.any()


def test_clutter_is_told_from_the_target_by_how_well_it_fits():
    belief, positions, z = drawn(3, 400)
    assert np.mean(own(belief, positions, z)[1] > 0.5) > 0.97
    away = z + np.array([6.0 * np.sqrt(belief.P[:, 0, 0] + belief.P[:, 1, 1]).max(), 0.0])
    assert np.mean(own(belief, positions, away)[1] > 0.5) < 0.03


def test_noise_about_zero_is_told_from_the_target():
    belief, positions, z = drawn(4, 400)
    noise = np.random.default_rng(0).normal(0.0, [0.1, 0.5], (400, 2))
    assert np.all(own(belief, positions, noise, loss='zero')[1] < 0.5)
    assert np.all(own(belief, positions, z, loss='zero')[1] > 0.5)


@properties
@given(seeds, st.integers(1, 3))
def test_quarter_turns_of_the_world_turn_the_contribution(seed, quarters):
    """The bearing has no seam. The points of a round belief are the same after a quarter turn: nothing else differs."""
    belief, position, z = drawn(seed)
    c, s = round(np.cos(quarters * np.pi / 2)), round(np.sin(quarters * np.pi / 2))
    turn = np.array([[c, -s], [s, c]])
    both = np.kron(np.eye(2), turn)
    S = np.diag([3.0, 3.0, 1.0, 1.0])
    here = own(Belief(belief.m, S), position, z)
    moved = np.concatenate([turn @ position[:2], [0.0]])
    there = own(Belief(both @ belief.m, S), moved, np.array([z[0], turned(z[1] + quarters * np.pi / 2)]))
    assert there.mu == pytest.approx(here.mu, rel=1e-6, abs=1e-12)
    assert there.information.matrix == pytest.approx(both @ here.information.matrix @ both.T, rel=1e-6, abs=1e-9)
    assert there.information.vector == pytest.approx(both @ here.information.vector, rel=1e-5, abs=1e-6)


def test_due_west_equals_due_east():
    """Turned by half a circle, where the points of the rule are the same."""
    S = np.diag([3.0, 3.0, 1.0, 1.0])
    east = own(Belief(np.array([80.0, 2.0, 5.0, 1.0]), S), np.zeros(3), np.array([81.0, 0.1]))
    west = own(Belief(np.array([-80.0, -2.0, -5.0, -1.0]), S), np.zeros(3), np.array([81.0, 0.1 - np.pi]))
    assert west.information.matrix == pytest.approx(east.information.matrix, rel=1e-9, abs=1e-12)
    assert west.information.vector == pytest.approx(-east.information.vector, rel=1e-9, abs=1e-12)
    assert west.mu == pytest.approx(east.mu, rel=1e-9)


def test_a_batch_equals_its_nodes_one_by_one():
    belief, positions, z = drawn(5, 12, 10)
    z[3, 4, 1] = z[7, 2, 0] = np.nan
    whole = own(belief, positions, z)
    for at in [(0, 0), (3, 4), (7, 2), (11, 9)]:
        one = own(Belief(belief.m[at], belief.chol_P[at]), positions[at], z[at])
        assert packed(one.information) == pytest.approx(packed(whole.information)[at], rel=1e-9, abs=1e-12)
        assert one.mu == pytest.approx(whole.mu[at], rel=1e-9)


def test_angles_are_wrapped_to_half_open_turn():
    assert wrapped([np.pi, -np.pi, 3 * np.pi, 0.0]).tolist() == pytest.approx([np.pi, np.pi, np.pi, 0.0])
    angles = np.linspace(-20.0, 20.0, 999)
    assert wrapped(angles) == pytest.approx(turned(angles), abs=1e-12)
    assert innovation(np.array([5.0, 3.1]), np.array([4.0, -3.1])) == pytest.approx([1.0, 6.2 - 2 * np.pi])


def test_a_target_at_another_height_is_further_away():
    h = range_bearing_function(np.array([0.0, 0.0, 1.0]), np.array([3.0, 0.0, 0.0, 0.0]), height=5.0)
    assert h(np.array([[3.0, 0.0, 0.0, 0.0]]))[0] == pytest.approx([5.0, 0.0])


# --- the two forms


@properties
@given(seeds, st.sampled_from([(), (3,), (20, 5)]))
def test_information_form_leads_back_to_the_belief(seed, shape):
    belief, _, _ = drawn(seed, *shape)
    there = to_information(belief)
    assert there.matrix @ belief.P == pytest.approx(np.broadcast_to(np.eye(4), belief.P.shape), abs=1e-7)
    assert (belief.P @ there.vector[..., None])[..., 0] == pytest.approx(belief.m, rel=1e-7, abs=1e-6)
    back = to_belief(there)
    assert back.m == pytest.approx(belief.m, rel=1e-7, abs=1e-6)
    assert back.chol_P == pytest.approx(belief.chol_P, rel=1e-6, abs=1e-7)
    np.testing.assert_array_equal(back.chol_P, np.tril(back.chol_P))
    assert packed(unpacked(packed(there))).tolist() == packed(there).tolist()
    np.testing.assert_array_equal(unpacked(packed(there)).matrix[..., 0, :], there.matrix[..., 0, :])


def test_definiteness_is_told_matrix_by_matrix():
    Y = np.stack([np.eye(4), np.diag([1.0, 1.0, -1e-3, 1.0]), 5.0 * np.eye(4)])
    assert is_definite(Information(np.zeros((3, 4)), Y)).tolist() == [True, False, True]
    assert is_definite(Information(np.zeros((2, 4)), Y[::2])).tolist() == [True, True]


def test_a_matrix_that_counts_as_definite_has_a_belief():
    """Of rank 3, definite by rounding alone: some have a root in one order of the states and not in the other."""
    A = np.random.default_rng(0).standard_normal((400, 4, 3))
    information = Information(np.zeros((400, 4)), A @ np.swapaxes(A, -1, -2))
    definite = is_definite(information)
    assert 0 < definite.sum() < 400
    assert np.isfinite(to_belief(Information(*(part[definite] for part in information))).chol_P).all()


@pytest.mark.parametrize('batch', [(), (5,), (9, 10)])
def test_forward_substitution_solves(batch):
    rng = np.random.default_rng(1)
    L = np.tril(rng.standard_normal((*batch, 4, 4))) + 3.0 * np.eye(4)
    B = rng.standard_normal((*batch, 4, 2))
    assert L @ forward(L, B) == pytest.approx(B, abs=1e-12)
    assert L @ inverse(L) == pytest.approx(np.broadcast_to(np.eye(4), L.shape), abs=1e-12)
    np.testing.assert_array_equal(inverse(L), np.tril(inverse(L)))
