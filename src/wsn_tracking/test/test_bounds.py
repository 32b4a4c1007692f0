"""What filters are measured against: covariances along the true path."""

import numpy as np
import pytest

from wsn_tracking.models.motion import constant_velocity, turn_jacobian
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.reproduction.bounds import path_bound, range_bearing_information, scalar_information

F = constant_velocity(1.0)
Q = np.square(0.1) * white_acceleration(1.0, 1.0) @ white_acceleration(1.0, 1.0).T
NODES = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0]])


def kalman(P, H, R, F, Q, epochs):
    """Covariances of the textbook filter."""
    found = []
    for _ in range(epochs):
        S = H @ P @ H.T + R
        P = P - P @ H.T @ np.linalg.solve(S, H @ P)
        found.append(P)
        P = F @ P @ F.T + Q
    return np.array(found)


def test_of_linear_readings_it_is_the_covariance_of_the_kalman_filter():
    H, R = np.eye(2, 4), np.diag([0.5, 2.0])
    information = np.broadcast_to(H.T @ np.linalg.solve(R, H), (3, 20, 4, 4))
    expected = kalman(np.eye(4), H, R, F, Q, 20)
    assert path_bound(np.eye(4), F, Q, information) == pytest.approx(np.broadcast_to(expected, (3, 20, 4, 4)))


def test_steps_of_each_epoch_may_differ():
    """Process noise in one step alone: what comes before is as without it, what comes after is larger."""
    information = np.broadcast_to(np.diag([1.0, 1.0, 0.0, 0.0]), (20, 4, 4))
    each = np.zeros((20, 4, 4))
    calm = path_bound(np.eye(4), F, np.zeros((4, 4)), information)
    assert np.array_equal(path_bound(np.eye(4), np.broadcast_to(F, (20, 4, 4)), each, information), calm)
    each[9] = Q
    shaken = path_bound(np.eye(4), F, each, information)
    assert np.array_equal(shaken[:10], calm[:10])
    assert np.all(np.trace(shaken[10:] - calm[10:], axis1=-2, axis2=-1) > 0.0)


def test_information_of_distances_is_that_of_ranges_without_bearings():
    states = np.array([[3.0, 4.0, 0.1, 0.2], [-1.0, 5.0, 0.0, 0.0]])
    R = np.diag([0.25, 1e30])
    both = range_bearing_information(NODES, states, np.ones((2, 3)), R)
    assert scalar_information(NODES, states, np.full((2, 3), 4.0)) == pytest.approx(both, abs=1e-12)


def test_information_of_logarithms_is_that_of_distances_with_relative_errors():
    states = np.array([3.0, 4.0, 0.1, 0.2, 0.0])
    d = np.hypot(*(states[:2] - NODES[:, :2]).T)
    relative, absolute = np.full(3, 1.0 / 0.12**2), 1.0 / (0.12 * d) ** 2
    assert scalar_information(NODES, states, relative, inverse_distance=True) == pytest.approx(
        scalar_information(NODES, states, absolute)
    )


def test_without_readings_uncertainty_follows_the_motion():
    x = np.array([0.0, 0.0, 1.0, 2.0, 0.1])
    J = turn_jacobian(x, 1.0)
    P = path_bound(np.eye(5), J, np.zeros((5, 5)), np.zeros((2, 5, 5)))
    assert P[1] == pytest.approx(J @ J.T)
