"""Offsets of links as states that drift: what they add, what they keep, what they take up."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, beliefs, covariances, kalman, properties, seeds, some_silent
from robust_cases import epoch, estimator, ranges

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.robust import with_offsets
from wsn_tracking.filters.srckf import update
from wsn_tracking.models.measurement import constant_noise
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.models.offsets import drift
from wsn_tracking.trackers.random_q import predict_step, white_part
from wsn_tracking.trackers.random_q_config import RandomQConfig, RobustConfig


@properties
@given(seeds, st.integers(1, 3))
def test_offsets_are_states_that_add_to_a_linear_reading(seed, passes):
    """Against the Kalman update of the whole state with [A, I]."""
    rng = np.random.default_rng(seed)
    A, P, m = rng.standard_normal((3, 4)), covariances(rng, n=7), rng.standard_normal(7)
    z, std = some_silent(rng, rng.standard_normal(3), 0.3), rng.uniform(0.2, 2.0, 3)
    heard = np.flatnonzero(~np.isnan(z))
    whole = np.hstack([A, np.eye(3)])[heard]
    expected = kalman(m, P, z[heard], whole, np.diag(std[heard] ** 2))
    belief = Belief(m, np.linalg.cholesky(P))
    after = update(belief, z, lambda x: x[..., :4] @ A.T, constant_noise(std), passes, offsets=3)
    np.testing.assert_allclose(after.m, expected[0], atol=1e-7)
    np.testing.assert_allclose(after.P, expected[1], atol=1e-7)


@properties
@given(seeds)
def test_offsets_that_are_known_to_be_zero_change_nothing(seed):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng)
    belief = Belief(m, np.linalg.cholesky(P))
    z = some_silent(rng, H(m) * (1.0 + 0.12 * rng.standard_normal(12)))
    plain = update(belief, z, H, NOISE, 3)
    offset = update(with_offsets(belief, np.full(12, 1e-9)), z, H, NOISE, 3, offsets=12)
    np.testing.assert_allclose(offset.m[:4], plain.m, atol=1e-8)
    np.testing.assert_allclose(offset.P[:4, :4], plain.P, atol=1e-8)


@properties
@given(st.floats(0.01, 20.0), st.floats(0.1, 50.0), st.floats(0.1, 10.0))
def test_an_offset_keeps_its_variance_and_two_steps_are_one(dt, time, std):
    F, Q = constant_velocity(dt), white_acceleration(0.1, dt)
    A, root = drift(F, Q, dt, np.array([std, 2.0 * std]), time)
    np.testing.assert_array_equal(A[:4, :4], F)
    np.testing.assert_array_equal(root[:4, :4], Q)
    assert not A[:4, 4:].any()
    assert not A[4:, :4].any()
    stationary = np.diag([std**2, 4.0 * std**2])
    after = A[4:, 4:] @ stationary @ A[4:, 4:].T + root[4:, 4:] @ root[4:, 4:].T
    np.testing.assert_allclose(after, stationary, rtol=1e-9, atol=1e-12)
    half, _ = drift(F, Q, dt / 2.0, np.array([std, std]), time)
    np.testing.assert_allclose(half[4:, 4:] @ half[4:, 4:], A[4:, 4:], rtol=1e-12)
    np.testing.assert_allclose(A[4, 4], math.exp(-dt / time))


def test_no_time_leaves_a_belief_with_offsets_alone():
    config = RandomQConfig(robust=RobustConfig(offset_std=1.0))
    belief = with_offsets(Belief(np.ones(4), np.eye(4)), np.ones(12))
    assert predict_step(belief, 0.0, np.asarray(7.0), config) is belief
    later = predict_step(belief, 1.0, np.asarray(7.0), config)
    np.testing.assert_allclose(np.diag(later.P)[4:], 1.0)


def test_white_noise_beside_an_offset_makes_up_the_whole_but_never_vanishes():
    root = white_part(constant_noise(np.array([5.0, 1.0])), 3.0)(np.zeros((1, 4)))[0]
    np.testing.assert_allclose(root, [4.0, 0.25])


def test_offsets_take_up_a_link_that_reads_too_much():
    """Half of the links read 0.5 m too much or too little all the time: told as white noise, or as offsets."""
    rng = np.random.default_rng(7)
    plain, modelled = estimator(), estimator(robust=RobustConfig(offset_std=0.5, offset_time=50.0))
    away = []
    for k in range(60):
        z = ranges(k, rng)
        z[::2] += 0.5 * np.array([1, -1, 1, 1, -1, 1])
        both = [e.step(epoch(k, z, variance=0.01 + 0.25)) for e in (plain, modelled)]
        assert all(e.mean.shape == (4,) and e.covariance.shape == (4, 4) for e in both)
        away.append([np.hypot(*(e.mean - LOOP.truth[k])[:2]) for e in both])
    late = np.array(away)[20:].mean(axis=0)
    assert late[1] < 0.7 * late[0]


def test_feedback_keeps_what_is_known_of_the_offsets():
    rng = np.random.default_rng(8)
    track = estimator(robust=RobustConfig(offset_std=0.5))
    for k in range(5):
        last = track.step(epoch(k, ranges(k, rng)))
    before = track._belief
    track.feed_back(last._replace(mean=last.mean + 0.1, covariance=2.0 * last.covariance))
    after = track._belief
    np.testing.assert_allclose(after.m, before.m + np.array([0.1] * 4 + [0.0] * 12))
    np.testing.assert_allclose(after.P[:4, :4], 2.0 * before.P[:4, :4], rtol=1e-9)
    np.testing.assert_allclose(after.P[4:, 4:], before.P[4:, 4:], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(after.P[:4, 4:], 0.0, atol=1e-15)
    np.testing.assert_array_equal(after.chol_P, np.tril(after.chol_P))
