"""A local estimator of system A as a node runs it: one epoch after the other."""

import dataclasses
import math

import numpy as np
import pytest
from oracles import LOOP, H, dense_ckf, dense_predict
from random_q_cases import GIVEN, MEAN, STD, epoch, epochs, run

from wsn_tracking.bags.estimates import differences
from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.sensing import trigger
from wsn_tracking.studies.random_q_runs import repeated, sense, start_near, track
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.random_q import LocalEstimator, keep_inside
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, StartConfig, UpdateConfig


def test_an_estimator_is_algorithm_1():
    """Against the covariance form, with the estimator's own draws of q."""
    config = dataclasses.replace(GIVEN, update=UpdateConfig(r='measured'))
    m, P = np.array(MEAN), np.diag(np.square(STD))
    for k, (sent, estimate) in enumerate(zip(epochs(), run(config, epochs()), strict=True)):
        if k:
            m, P = dense_predict(m, P, constant_velocity(1.0), (0.01 * estimate.q) ** 2 * np.eye(4))
        rows = [i - 1 for i in estimate.measurements]
        z = np.array([p.range for p in sent.measurements])
        if rows:
            R = np.diag((1.56 * math.log(10.0) / 30.0 * z) ** 2)
            m, P = dense_ckf(m, P, z, lambda x, rows=rows: H(x)[..., rows], R)
        np.testing.assert_allclose(estimate.mean, m, atol=1e-10)
        np.testing.assert_allclose(estimate.covariance, P, atol=1e-10)
        assert estimate.contributors == (1,)
        assert estimate.kind == Kind.LOCAL
        assert (estimate.source, estimate.request_seq, estimate.stamp_ns) == ('local_1', k, k * 10**9)


def test_an_epoch_without_measurements_is_predicted_and_published():
    sequence = epochs()
    sequence[10] = sequence[10]._replace(measurements=())
    whole = run(GIVEN, sequence)
    before, after = whole[9], whole[10]
    np.testing.assert_allclose(after.mean, constant_velocity(1.0) @ before.mean, atol=1e-14)
    Q = (0.01 * after.q) ** 2 * np.eye(4)
    F = constant_velocity(1.0)
    np.testing.assert_allclose(after.covariance, F @ before.covariance @ F.T + Q, rtol=1e-10, atol=1e-15)
    assert after.measurements == ()
    assert GIVEN.noise.q_min <= after.q <= GIVEN.noise.q_max


def test_equal_epochs_give_equal_estimates_also_after_a_reset():
    estimator = LocalEstimator(GIVEN, LOOP.anchors, 1)
    first = [estimator.step(e) for e in epochs()]
    estimator.reset()
    assert differences(first, [estimator.step(e) for e in epochs()]) == []


def test_the_step_is_as_long_as_the_stamps_say():
    sequence = epochs(count=6)
    config = dataclasses.replace(GIVEN, noise=NoiseConfig(kind='acceleration'))
    gap = [e._replace(stamp_ns=e.stamp_ns + 2 * 10**9 * (k > 3), measurements=()) for k, e in enumerate(sequence)]
    one, other = run(config, gap)[3:5]
    np.testing.assert_allclose(other.mean, constant_velocity(3.0) @ one.mean, atol=1e-14)
    backwards = [e._replace(stamp_ns=-e.stamp_ns, measurements=()) for e in sequence]
    for estimate in run(config, backwards):
        np.testing.assert_allclose(estimate.mean, MEAN)  # time that runs backwards does not pass


@pytest.mark.parametrize('passes', [1, 3])
def test_iplf_of_one_pass_is_ckf_and_of_three_is_another(passes):
    ckf = run(GIVEN, epochs())
    iplf = run(dataclasses.replace(GIVEN, update=UpdateConfig(kind='iplf', passes=passes)), epochs())
    assert all(np.array_equal(a.mean, b.mean) for a, b in zip(ckf, iplf, strict=True)) == (passes == 1)


def test_positions_are_kept_inside_an_area():
    area = (0.7, 0.65, 0.8, 0.7)
    for estimate in run(dataclasses.replace(GIVEN, area=area), epochs()):
        assert area[0] <= estimate.mean[0] <= area[2]
        assert area[1] <= estimate.mean[1] <= area[3]
    free = run(GIVEN, epochs())[3]
    belief = Belief(free.mean, np.linalg.cholesky(free.covariance))
    assert keep_inside(belief, ()) is belief
    np.testing.assert_array_equal(keep_inside(belief, area).chol_P, belief.chol_P)


def test_the_start_takes_the_first_epochs_that_hold_something():
    sequence = epochs(count=12)
    config = RandomQConfig(area=LOOP.area, start=StartConfig(epochs=3, speed=0.06))
    estimates = run(config, sequence)
    full = [k for k, e in enumerate(sequence) if e.measurements]
    assert [e.kind for e in estimates] == [Kind.START] * (full[2] + 1) + [Kind.LOCAL] * (11 - full[2])
    assert not sequence[0].measurements  # the event trigger is silent at first
    away = np.hypot(*(estimates[full[2]].mean[:2] - LOOP.truth[full[2], :2]))
    assert away < 3.0 * math.sqrt(np.trace(estimates[full[2]].covariance[:2, :2]))
    # neither truth nor the area's middle: another target's measurements lead there
    elsewhere = [epoch(k, H(np.array([[2.9, 2.0]]))[0]) for k in range(4)]
    np.testing.assert_allclose(run(config, elsewhere)[-1].mean[:2], [2.9, 2.0], atol=0.1)


def test_feedback_goes_on_from_the_fused_estimate():
    estimator = LocalEstimator(GIVEN, LOOP.anchors, 1)
    first = estimator.step(epochs()[0])
    fused = first._replace(mean=first.mean + 1.0, covariance=4.0 * first.covariance)
    estimator.feed_back(fused)
    after = estimator.step(epoch(1, np.full(12, np.nan)))
    np.testing.assert_allclose(after.mean, constant_velocity(1.0) @ fused.mean, rtol=1e-12)


@pytest.mark.parametrize('options', [{}, {'r': 'measured'}, {'kind': 'iplf'}, {'kind': 'log', 'kappa': 1.0}])
def test_batched_runs_equal_the_estimator_run_by_run(options):
    update_config = UpdateConfig(**options)
    generator = np.random.default_rng(3)
    sensed = sense(LOOP, repeated(LOOP, 3)[:, :40], trigger.event(trigger.EventThresholds(alpha=0.3)), generator)
    start = start_near(sensed.states, generator)
    noise = NoiseConfig(q_min=2.0, q_max=12.0)
    u = generator.random((3, 2, 40))
    tracks = track(LOOP, sensed, start, RandomQConfig(noise=noise, update=update_config), u)
    for r, e in np.ndindex(3, 2):
        config = RandomQConfig(
            noise=noise, update=update_config, start=StartConfig(kind='given', mean=tuple(start.m[r]), std=STD)
        )
        estimator = LocalEstimator(config, LOOP.anchors, e)
        estimator.draw = lambda k, u=u[r, e]: 2.0 + 10.0 * u[k]
        for k in range(40):
            estimate = estimator.step(epoch(k, sensed.z[r, k]))
            np.testing.assert_allclose(tracks.m[r, e, k], estimate.mean, atol=1e-9)
            np.testing.assert_allclose(tracks.P[r, e, k], estimate.covariance, atol=1e-9)
