"""Motion and its noise: integrals over the step, two steps that are one, velocities that are forgotten."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import covariances, properties

from wsn_tracking.models.motion import constant_velocity, forgetful_velocity
from wsn_tracking.models.noise import scaled_identity, white_acceleration

steps = st.floats(1e-3, 20.0)
densities = st.floats(1e-6, 10.0)


def covariance_of(root):
    return root @ np.swapaxes(root, -1, -2)


@properties
@given(densities, steps)
def test_white_acceleration_is_the_integral_over_the_step(S, T):
    """Van Loan: the exponential of one block matrix holds F and Q of a linear stochastic differential equation."""
    expm = pytest.importorskip('scipy.linalg').expm
    A = np.kron([[0.0, 1.0], [0.0, 0.0]], np.eye(2))
    G = np.diag([0.0, 0.0, S, S])
    block = expm(np.block([[-A, G], [np.zeros((4, 4)), A.T]]) * T)
    F = block[4:, 4:].T
    np.testing.assert_allclose(constant_velocity(T), F, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(covariance_of(white_acceleration(S, T)), F @ block[:4, 4:], rtol=1e-9, atol=1e-15)


@properties
@given(densities, steps, steps)
def test_two_steps_are_one_long_step(S, T1, T2):
    F1, F2 = constant_velocity(T1), constant_velocity(T2)
    Q1, Q2 = covariance_of(white_acceleration(S, T1)), covariance_of(white_acceleration(S, T2))
    np.testing.assert_allclose(constant_velocity(T1 + T2), F2 @ F1, rtol=1e-12)
    whole = covariance_of(white_acceleration(S, T1 + T2))
    np.testing.assert_allclose(whole, F2 @ Q1 @ F2.T + Q2, rtol=1e-10, atol=1e-15)


@pytest.mark.parametrize(('T', 'tau'), [(0.01, 5.0), (0.5, 5.0), (3.0, 2.0), (30.0, 7.0)])
def test_noise_of_a_velocity_that_is_forgotten_is_the_integral_over_the_step(T, tau):
    """Van Loan again, of a velocity that is forgotten."""
    expm = pytest.importorskip('scipy.linalg').expm
    S, A = 0.3, np.kron([[0.0, 1.0], [0.0, -1.0 / tau]], np.eye(2))
    block = expm(np.block([[-A, np.diag([0.0, 0.0, S, S])], [np.zeros((4, 4)), A.T]]) * T)
    F = block[4:, 4:].T
    transition, root = forgetful_velocity(S, T, tau)
    np.testing.assert_allclose(transition, F, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(root, np.tril(root))
    np.testing.assert_allclose(covariance_of(root), F @ block[:4, 4:], rtol=1e-8, atol=1e-12)


@properties
@given(densities, steps, steps)
def test_two_steps_of_a_velocity_that_is_forgotten_are_one_long_step(S, T1, T2):
    (F1, L1), (F2, L2), (F, L) = (forgetful_velocity(S, T, 3.0) for T in (T1, T2, T1 + T2))
    np.testing.assert_allclose(F, F2 @ F1, rtol=1e-12, atol=1e-15)
    both = F2 @ covariance_of(L1) @ F2.T + covariance_of(L2)
    np.testing.assert_allclose(covariance_of(L), both, rtol=1e-5, atol=1e-12)


@pytest.mark.filterwarnings('error')
def test_nothing_happens_in_no_time():
    for tau in (0.0, 3.0):
        F, root = forgetful_velocity(0.3, 0.0, tau)
        np.testing.assert_array_equal(F, np.eye(4))
        np.testing.assert_array_equal(root, np.zeros((4, 4)))


@pytest.mark.parametrize('T', [1e-9, 1e-4, 0.5, 3.0])
def test_a_velocity_that_is_hardly_forgotten_is_constant(T):
    F, root = forgetful_velocity(0.3, T, 1e5)
    np.testing.assert_allclose(F, constant_velocity(T), rtol=1e-4)
    np.testing.assert_allclose(covariance_of(root), covariance_of(white_acceleration(0.3, T)), rtol=1e-3)


def test_noise_roots_are_lower_triangular_and_batched():
    S, T = np.array([[0.5], [2.0], [1e-4]]), np.array([0.1, 1.0])
    L = white_acceleration(S, T)
    assert L.shape == (3, 2, 4, 4)
    np.testing.assert_array_equal(L, np.tril(L))
    np.testing.assert_array_equal(L[1, 0], white_acceleration(2.0, 0.1))
    assert not white_acceleration(2.0, 0.0).any()
    assert constant_velocity(T).shape == (2, 4, 4)


def test_the_documents_q_counts_centimetres():
    """S_Q = 7 I in cm and cm/s: a standard deviation of 7 cm and 7 cm/s."""
    np.testing.assert_allclose(scaled_identity(7.0), 0.07 * np.eye(4), rtol=1e-15)
    np.testing.assert_allclose(scaled_identity(np.array([[2.0], [6.0]]))[1, 0], 0.06 * np.eye(4), rtol=1e-15)


def test_a_step_moves_positions_by_velocities():
    x = np.array([1.0, 2.0, 0.3, -0.5])
    np.testing.assert_allclose(constant_velocity(2.0) @ x, [1.6, 1.0, 0.3, -0.5])


def test_covariances_of_the_oracle_are_covariances():
    P = covariances(np.random.default_rng(0), 5, 2, condition=1e6)
    assert P.shape == (5, 2, 4, 4)
    assert np.linalg.eigvalsh(P).min() > 0.0
