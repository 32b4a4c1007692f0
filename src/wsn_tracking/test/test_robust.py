"""Heavy tails and the gate: what a wild reading may do to an estimate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, beliefs, properties, seeds, some_silent
from robust_cases import epoch, estimator, ranges

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import regress
from wsn_tracking.filters.linalg import matvec, tria
from wsn_tracking.filters.robust import gated, student_t, with_offsets
from wsn_tracking.filters.srckf import predict, update
from wsn_tracking.models.measurement import constant_noise
from wsn_tracking.trackers.random_q_config import RobustConfig, UpdateConfig


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


def test_estimators_of_every_update_track_with_every_option():
    rng = np.random.default_rng(9)
    robust = RobustConfig(dof=4.0, gate=5.0, offset_std=0.1)
    for kind in ('ckf', 'iplf', 'log'):
        track = estimator(update=UpdateConfig(kind=kind, kappa=1.0), robust=robust)
        for k in range(30):
            last = track.step(epoch(k, some_silent(rng, ranges(k, rng), 0.4)))
        assert np.hypot(*(last.mean - LOOP.truth[29])[:2]) < 0.3
