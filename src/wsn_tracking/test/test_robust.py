"""What real radio needs: heavy tails, a gate, drifting offsets of links, wider points, a new start."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, beliefs, covariances, kalman, properties, seeds, some_silent

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import points, regress
from wsn_tracking.filters.linalg import matvec, transpose, tria
from wsn_tracking.filters.robust import gated, student_t, with_offsets
from wsn_tracking.filters.srckf import predict, update
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import constant_noise
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.models.offsets import drift
from wsn_tracking.sensing.values import Epoch, Modality, Range
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.random_q import LocalEstimator, predict_step, white_part
from wsn_tracking.trackers.random_q_config import (
    NoiseConfig,
    RandomQConfig,
    ReacquireConfig,
    RobustConfig,
    StartConfig,
    UpdateConfig,
)

IDS = LOOP.anchors.ids.tolist()


# --- wider points


@properties
@given(seeds, st.floats(0.1, 10.0))
def test_unscented_points_have_the_beliefs_mean_and_covariance(seed, kappa):
    m, P = beliefs(np.random.default_rng(seed), 3)
    X = points(Belief(m, np.linalg.cholesky(P)), kappa)
    w = np.array([*[0.5] * 8, kappa]) / (4.0 + kappa)
    np.testing.assert_allclose(w @ X, m, atol=1e-12)
    d = X - m[:, None]
    np.testing.assert_allclose(transpose(d) @ (w[:, None] * d), P, atol=1e-12)


@properties
@given(seeds, st.floats(0.1, 10.0))
def test_regression_keeps_every_moment_of_the_unscented_rule(seed, kappa):
    m, P = beliefs(np.random.default_rng(seed), position_std=0.4)
    belief = Belief(m, np.linalg.cholesky(P))
    X = points(belief, kappa)
    w = np.array([*[0.5] * 8, kappa]) / (4.0 + kappa)
    d = H(X) - w @ H(X)
    r = regress(H, belief, kappa)
    np.testing.assert_allclose(r.z_hat, w @ H(X), rtol=1e-12)
    np.testing.assert_allclose(r.O @ r.O.T + r.E @ r.E.T, d.T @ (w[:, None] * d), atol=1e-12)
    np.testing.assert_allclose(belief.chol_P @ r.O.T, (X - m).T @ (w[:, None] * d), atol=1e-12)


def test_wider_points_are_the_same_filter_on_a_linear_measurement():
    rng = np.random.default_rng(1)
    A, P, m, z = rng.standard_normal((6, 4)), covariances(rng), rng.standard_normal(4), rng.standard_normal(6)
    after = update(Belief(m, np.linalg.cholesky(P)), z, lambda x: x @ A.T, constant_noise(np.ones(6)), 2, kappa=3.0)
    expected = kalman(m, P, z, A, np.eye(6))
    np.testing.assert_allclose(after.m, expected[0], atol=1e-9)
    np.testing.assert_allclose(after.P, expected[1], atol=1e-9)


# --- offsets of links


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


# --- heavy tails and the gate


@properties
@given(seeds, st.floats(1.0, 30.0))
def test_student_noise_grows_with_the_residual(seed, dof):
    rng = np.random.default_rng(seed)
    x, std, e = rng.random((1, 4)), rng.uniform(0.5, 2.0, 12), 5.0 * rng.standard_normal(12)
    e[3] = np.nan
    root = student_t(constant_noise(std), H(x)[0] + e * std, H, dof)(x)[0]
    expected = std**2 * (dof + np.where(np.isnan(e), 0.0, e**2)) / (dof + 1.0)
    np.testing.assert_allclose(root**2, expected, rtol=1e-9)


def test_iterated_student_update_finds_the_maximum_of_the_posterior():
    """Two linear readings of one state, one far out: the fixed point is where the gradient of the posterior is zero."""
    dof, z = 4.0, np.array([0.1, 8.0])
    A, std = np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([0.5, 0.5])

    def h(x):
        return x @ A.T

    noise = student_t(constant_noise(std), z, h, dof)
    x = update(Belief(np.zeros(2), np.eye(2)), z, h, noise, passes=200).m[0]
    e = z - x
    gradient = -x + np.sum((dof + 1.0) * e / (dof * std**2 + e**2))
    assert gradient == pytest.approx(0.0, abs=1e-6)
    assert abs(x) < 1.0  # the outlier is all but ignored
    assert update(Belief(np.zeros(2), np.eye(2)), z, h, constant_noise(std)).m[0] > 3.0


def test_the_gate_is_a_number_of_standard_deviations_of_the_innovation():
    belief = Belief(LOOP.truth[7], 0.1 * np.eye(4))
    r = regress(H, belief)
    root = NOISE(belief.m[None])[0]
    S = np.sqrt(np.diag(r.O @ r.O.T + r.E @ r.E.T) + root**2)
    z = r.z_hat + S * np.array([0.0, 2.9, -2.9, 3.1, -3.1, np.nan, *[1.0] * 6])
    np.testing.assert_array_equal(np.isnan(gated(z, r, root, 3.0)), [0, 0, 0, 1, 1, 1, *[0] * 6])


# --- an estimator with all of it


def epoch(k, z, variance=0.01):
    heard = [(i, float(r)) for i, r in zip(IDS, z, strict=True) if not np.isnan(r)]
    stamp_ns = k * 10**9
    return Epoch(1, k, stamp_ns, tuple(Range(stamp_ns, i, 1, k, k, Modality.UWB, r, variance) for i, r in heard))


def estimator(**options):
    given = StartConfig(kind='given', mean=tuple(LOOP.truth[0]), epochs=1)
    acceleration = NoiseConfig(kind='acceleration')
    config = dataclasses.replace(RandomQConfig(start=given, noise=acceleration, area=LOOP.area), **options)
    return LocalEstimator(config, LOOP.anchors, 1)


def ranges(k, rng):
    return H(LOOP.truth[k]) + 0.1 * rng.standard_normal(12)


def test_a_gate_keeps_a_wild_range_out_and_counts_it():
    rng = np.random.default_rng(4)
    careful, naive = estimator(robust=RobustConfig(gate=4.0)), estimator()
    for k in range(20):
        z = ranges(k, rng)
        z[2] += 3.0 * (k == 15)
        a, b = careful.step(epoch(k, z)), naive.step(epoch(k, z))
        assert (3 in a.measurements) == (k != 15)
        assert 3 in b.measurements
    assert careful.counters == {'gated': 1}


def test_a_lost_track_is_found_anew():
    """The target is carried off: most ranges are rejected until the filter starts again where it is now."""
    rng = np.random.default_rng(5)
    lost = estimator(robust=RobustConfig(gate=4.0), reacquire=ReacquireConfig(rejects=3, window=2.0))
    stuck = estimator(robust=RobustConfig(gate=4.0))
    kinds = []
    for k in range(20):
        at = k if k < 10 else k + 40  # the opposite side of the loop
        found, kept = (e.step(epoch(k, ranges(at, rng))) for e in (lost, stuck))
        kinds.append(found.kind)
    assert kinds.count(Kind.START) == 1
    assert lost.counters['reacquired_after_rejects'] == 1
    assert np.hypot(*(found.mean - LOOP.truth[59])[:2]) < 0.3
    assert np.hypot(*(kept.mean - LOOP.truth[59])[:2]) > 0.5


def test_after_a_long_silence_the_filter_starts_anew():
    rng = np.random.default_rng(6)
    track = estimator(reacquire=ReacquireConfig(silence=5.0))
    for k in range(3):
        assert track.step(epoch(k, ranges(k, rng))).kind == Kind.LOCAL
    for k in range(3, 12):
        assert track.step(epoch(k, np.full(12, np.nan))).kind == Kind.LOCAL
    back = track.step(epoch(12, ranges(60, rng)))
    assert back.kind == Kind.START
    assert np.hypot(*(back.mean - LOOP.truth[60])[:2]) < 0.3
    assert track.counters == {'reacquired_after_silence': 1}
    assert track.step(epoch(13, ranges(61, rng))).kind == Kind.LOCAL


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


@properties
@given(seeds, st.integers(1, 3), st.floats(0.0, 3.0), st.sampled_from([0.0, 4.0]))
def test_every_option_batched_equals_one_by_one(seed, passes, kappa, dof):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, 3)
    belief = with_offsets(Belief(m, np.linalg.cholesky(P)), np.full(12, 0.2))
    belief = predict(belief, np.eye(16), tria(0.01 * rng.standard_normal((16, 16))))
    z = some_silent(rng, H(m) + 0.3 * rng.standard_normal((3, 12)))

    def step(one, z):
        def read(x):
            return H(x[..., :4]) + x[..., 4:]

        noise = student_t(NOISE, z, read, dof) if dof else NOISE
        return update(one, z, H, noise, passes, kappa, 12)

    batch = step(belief, z)
    for i in range(3):
        one = step(Belief(belief.m[i], belief.chol_P[i]), z[i])
        np.testing.assert_allclose(batch.m[i], one.m, atol=1e-9)
        np.testing.assert_allclose(batch.chol_P[i], one.chol_P, atol=1e-9)
    assert np.all(np.isfinite(matvec(batch.chol_P, batch.m)))


def test_log_and_iplf_estimators_run_with_every_option():
    rng = np.random.default_rng(9)
    robust = RobustConfig(dof=4.0, gate=5.0, offset_std=0.1)
    for kind in ('ckf', 'iplf', 'log'):
        track = estimator(update=UpdateConfig(kind=kind, kappa=1.0), robust=robust)
        for k in range(30):
            last = track.step(epoch(k, some_silent(rng, ranges(k, rng), 0.4)))
        assert np.hypot(*(last.mean - LOOP.truth[29])[:2]) < 0.3


@pytest.mark.parametrize('std', [0.1, 0.5])
def test_a_track_in_the_wrong_place_is_found_anew_and_no_other(std):
    """Set off in the wrong corner, sure of it, ranges taken for worse than they are: no gate would reject any."""
    rng = np.random.default_rng(10)
    wrong = StartConfig(kind='given', mean=(3.4, 2.2, 0.0, 0.0), std=(0.05, 0.05, 0.01, 0.01))
    odds = ReacquireConfig(odds=4.0, window=4.0)
    astray, right = estimator(start=wrong, reacquire=odds), estimator(reacquire=odds)
    for k in range(60):
        given = epoch(k, H(LOOP.truth[k]) + std * rng.standard_normal(12), variance=0.7**2)
        found, kept = astray.step(given), right.step(given)
        assert kept.kind == Kind.LOCAL
        assert (found.kind == Kind.START) == (k == 4)
        assert k < 4 or np.hypot(*(found.mean - LOOP.truth[k])[:2]) < 1.0
    assert astray.counters == {'reacquired_elsewhere': 1}
    assert right.counters == {}


def test_several_places_that_suit_equally_are_no_reason_to_leave_the_track():
    """Two nodes leave two places; their middle suits none."""
    anchors = make_anchors([1, 2], [[0.0, 0.0], [4.0, 0.0]])
    start = StartConfig(kind='given', mean=(2.0, 1.5, 0.0, 0.0), std=(0.1, 0.1, 0.01, 0.01))
    config = RandomQConfig(start=start, noise=NoiseConfig(kind='acceleration'), reacquire=ReacquireConfig(odds=0.5))
    track = LocalEstimator(config, anchors, 1)
    for k in range(20):
        heard = tuple(Range(k * 10**9, i, 1, k, k, Modality.UWB, 2.5, 0.01) for i in (1, 2))
        estimate = track.step(Epoch(1, k, k * 10**9, heard))
    np.testing.assert_allclose(estimate.mean[:2], [2.0, 1.5], atol=0.05)
    assert track.counters == {}
