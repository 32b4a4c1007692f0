"""The process noise of system A: its kinds, and draws of q that belong to their epoch."""

import dataclasses

import numpy as np
import pytest
from oracles import LOOP
from random_q_cases import GIVEN, epochs, run

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.noise import scaled_identity, white_acceleration
from wsn_tracking.trackers.random_q import LocalEstimator, motion_of
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig


def test_identity_noise_is_q_times_one_and_nothing_passes_in_no_time():
    q = np.array([2.0, 7.0])
    np.testing.assert_array_equal(motion_of(NoiseConfig(), q, 1.0)[1], scaled_identity(q))
    F, chol_Q = motion_of(NoiseConfig(), q, 0.0)
    np.testing.assert_array_equal(F, np.eye(4))
    assert not chol_Q.any()
    assert chol_Q.shape == (2, 4, 4)


def test_acceleration_noise_is_scaled_on_its_root_by_2q_over_the_sum_of_the_bounds():
    config = NoiseConfig(kind='acceleration', q_min=2.0, q_max=6.0, spectral_density=0.3)
    whole = white_acceleration(0.3, 0.5)
    np.testing.assert_allclose(motion_of(config, np.array(4.0), 0.5)[1], whole)
    np.testing.assert_allclose(motion_of(config, np.array([2.0, 6.0]), 0.5)[1], [0.5 * whole, 1.5 * whole])


def test_a_velocity_that_is_forgotten_ends_where_it_began():
    """Long after the last reading a velocity has variance S time / 2, and no memory of what it was."""
    noise = NoiseConfig(kind='acceleration', spectral_density=0.25, velocity_time=2.0)
    F, chol_Q = motion_of(noise, np.array(7.0), 100.0)
    np.testing.assert_allclose(F[:, 2:], [[2.0, 0.0], [0.0, 2.0], [0.0, 0.0], [0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose((chol_Q @ chol_Q.T)[2:, 2:], 0.25 * np.eye(2), atol=1e-12)


def test_a_velocity_is_not_forgotten_without_white_acceleration():
    with pytest.raises(TrackingError, match='belongs to white acceleration'):
        RandomQConfig(noise=NoiseConfig(velocity_time=2.0)).checked()


def test_q_is_uniform_between_its_bounds_and_of_each_estimator_its_own():
    stats = pytest.importorskip('scipy.stats')
    config = dataclasses.replace(GIVEN, seed=9, noise=NoiseConfig(q_min=2.0, q_max=12.0))
    one, two = (np.array([LocalEstimator(config, LOOP.anchors, i).draw(k) for k in range(1000)]) for i in (1, 2))
    assert stats.kstest(one, 'uniform', (2.0, 10.0)).pvalue > 0.01
    assert abs(np.corrcoef(one, two)[0, 1]) < 0.12  # four standard deviations


def test_a_draw_depends_on_the_epoch_alone():
    """A restart, a lost epoch or a gap shifts nothing."""
    sequence = epochs()
    whole = run(GIVEN, sequence)
    late = run(GIVEN, sequence[7:])
    assert [e.q for e in late] == [e.q for e in whole[7:]]
    assert len({e.q for e in whole}) == len(whole)
    assert [e.q for e in run(dataclasses.replace(GIVEN, seed=1), sequence)] != [e.q for e in whole]
