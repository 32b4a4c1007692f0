"""Offsets of links within a particle filter are Kalman filters of one state each."""

import math

import numpy as np
import pytest

from wsn_tracking.filters.link_offsets import Drift, Offsets, drifted, learnt, unknown

DRIFT = Drift(3.0, 5.0)
SIGMA = np.array([4.0, 2.0])


def test_they_keep_the_variance_that_they_have_when_nothing_is_read():
    offsets = unknown(DRIFT, (2,), 5)
    later = drifted(offsets, DRIFT, 2.0)
    np.testing.assert_allclose(later.V, [9.0, 9.0])
    np.testing.assert_array_equal(later.b, np.zeros((2, 5)))


def test_what_was_read_is_forgotten_with_time():
    offsets = Offsets(np.full((2, 5), 4.0), np.array([1.0, 2.0]))
    later = drifted(offsets, DRIFT, 5.0)
    np.testing.assert_allclose(later.b, 4.0 / math.e)
    np.testing.assert_allclose(later.V, 9.0 + (np.array([1.0, 2.0]) - 9.0) / math.e**2)
    assert drifted(offsets, DRIFT, -3.0) is not offsets
    np.testing.assert_array_equal(drifted(offsets, DRIFT, -3.0).b, offsets.b)


def test_one_particle_is_a_kalman_filter():
    """Five epochs, one of them silent, against the equations of a scalar filter; e is measured from its mean."""
    rng = np.random.default_rng(1)
    offsets, m, P = unknown(DRIFT, (1,), 1), 0.0, 9.0
    for k in range(5):
        offsets = drifted(offsets, DRIFT, 0.5)
        a = math.exp(-0.1)
        m, P = a * m, a * a * P + 9.0 * (1.0 - a * a)
        z = math.nan if k == 2 else float(rng.normal())
        offsets = learnt(offsets, z - offsets.b, SIGMA[:1], np.ones(1))
        if k != 2:
            K = P / (P + 16.0)
            m, P = m + K * (z - m), (1.0 - K) * P
        assert offsets.b[0, 0] == pytest.approx(m)
        assert offsets.V[0] == pytest.approx(P)


def test_particles_share_the_variance_and_not_the_mean():
    e = np.array([[1.0, -2.0, 3.0], [0.0, math.nan, math.nan]])
    after = learnt(unknown(DRIFT, (2,), 3), e, SIGMA, np.array([0.2, 0.3, 0.5]))
    np.testing.assert_allclose(after.b[0], 9.0 / 25.0 * e[0])
    assert after.V[0] == pytest.approx(9.0 * 16.0 / 25.0)


def test_a_reading_far_out_teaches_little_with_student_t():
    """Half of Student's t: lambda falls with e^2, so that a wild reading moves an offset less than a likely one."""
    start, w = unknown(DRIFT, (2,), 1), np.ones(1)
    moved = [learnt(start, np.full((2, 1), e), SIGMA, w, 4.0).b[0, 0] for e in (5.0, 60.0)]
    assert 0.0 < moved[1] < moved[0]
    normal = learnt(start, np.full((2, 1), 5.0), SIGMA, w)
    nearly = learnt(start, np.full((2, 1), 5.0), SIGMA, w, 1e9)
    np.testing.assert_allclose(nearly.b, normal.b, rtol=1e-6)


def test_runs_are_alike_whether_alone_or_in_a_batch():
    rng = np.random.default_rng(2)
    e, w = rng.normal(size=(3, 2, 4)), rng.dirichlet(np.ones(4), 3)
    sigma = np.abs(rng.normal(size=(3, 2))) + 1.0
    batch = learnt(unknown(DRIFT, (3, 2), 4), e, sigma, w, 3.0)
    for r in range(3):
        alone = learnt(unknown(DRIFT, (2,), 4), e[r], sigma[r], w[r], 3.0)
        np.testing.assert_allclose(batch.b[r], alone.b)
        np.testing.assert_allclose(batch.V[r], alone.V)
