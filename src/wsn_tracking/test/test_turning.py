"""The coordinated turn, and the filters of turning targets against dense ones."""

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import covariances, properties, seeds
from turning_cases import dense_predict, dense_update, differences, integrated, noise, turned

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters import linearised, turning
from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import constant_noise, range_function, rssi_function
from wsn_tracking.models.motion import coordinated_turn, turn_jacobian
from wsn_tracking.models.noise import turn_noise
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig, TurnConfig, TurningStartConfig
from wsn_tracking.trackers.turning import filter_of, held, with_turn

SCALE = np.array([4.0, 4.0, 1.5, 1.5, 0.1])
SV, SW = 0.4, np.radians(1.5)
ANCHORS = make_anchors(
    np.arange(9), np.column_stack([np.repeat([0.0, 40.0, 90.0], 3), np.tile([5.0, 50.0, 80.0], 3), np.arange(9)]),
    p1_dbm=-40.0, sigma_db=4.0,
)  # fmt: skip
H, R = rssi_function(ANCHORS, 1.0), np.diag(np.square(ANCHORS.sigma_db))
RATES = [0.0, 1e-12, -1e-9, 9e-7, 1e-6, -1.1e-6, 1e-4, 9.99e-3, -1.001e-2, 0.17, -1.3]


def drawn(seed, *shape):
    """Beliefs in the field, and what is heard of them."""
    rng = np.random.default_rng(seed)
    P = covariances(rng, *shape, n=5, condition=30.0) * np.outer(SCALE, SCALE)
    m = np.array([10.0, 10.0, -3.0, -3.0, -0.2]) + np.array([70.0, 70.0, 6.0, 6.0, 0.4]) * rng.random((*shape, 5))
    z = H(m[..., None, :])[..., 0, :] + 4.0 * rng.standard_normal((*shape, 9))
    return Belief(m, np.linalg.cholesky(P)), np.where(rng.random(z.shape) < 0.4, np.nan, z)


# ---- the model


@pytest.mark.parametrize('w', RATES)
@pytest.mark.parametrize('T', [0.1, 1.0, 30.0])
def test_the_turn_is_the_integral_of_its_equation(w, T):
    """Runge-Kutta of 4000 steps is good to 1e-12 of the way, in double precision."""
    x = np.array([3.0, -2.0, 1.5, 2.5, w])
    assert coordinated_turn(x, T) == pytest.approx(integrated(x, T), rel=1e-9, abs=1e-9 * T)


@pytest.mark.parametrize('w', RATES)
def test_the_jacobian_is_the_slope_of_the_turn(w):
    """Central differences of a step 1e-4: their own error is some 1e-8 times third derivatives below 10."""
    x = np.array([3.0, -2.0, 1.5, 2.5, w])
    slope = differences(lambda x: coordinated_turn(x, 1.7), x, np.full(5, 1e-4))
    np.testing.assert_allclose(turn_jacobian(x, 1.7), slope, atol=1e-7)


def test_series_and_closed_form_of_the_slopes_meet():
    """About the angle where one takes over from the other, the jacobian does not jump by more than it runs."""
    below, above = (turn_jacobian(np.array([0.0, 0.0, 1.0, 1.0, w]), 1.0) for w in (0.01 - 1e-12, 0.01 + 1e-12))
    np.testing.assert_allclose(below, above, atol=1e-11)


def test_a_turn_goes_round_its_circle():
    """At w = 0.5 rad/s and 2 m/s the radius is 4 m, the centre to the left."""
    x = np.array([1.0, 2.0, 2.0, 0.0, 0.5])
    for T in np.linspace(0.0, 20.0, 9):
        y = coordinated_turn(x, T)
        assert np.hypot(*(y[:2] - [1.0, 6.0])) == pytest.approx(4.0)
        assert np.hypot(*y[2:4]) == pytest.approx(2.0)
    np.testing.assert_allclose(coordinated_turn(x, 4.0 * np.pi), x, atol=1e-12)


def test_states_and_times_broadcast():
    x, T = drawn(1, 6)[0].m, np.linspace(0.1, 2.0, 4)[:, None]
    batched, slopes = coordinated_turn(x, T), turn_jacobian(x, T)
    assert (batched.shape, slopes.shape) == ((4, 6, 5), (4, 6, 5, 5))
    np.testing.assert_array_equal(batched[2, 3], coordinated_turn(x[3], T[2, 0]))
    np.testing.assert_array_equal(slopes[2, 3], turn_jacobian(x[3], T[2, 0]))


@pytest.mark.parametrize('T', [0.1, 1.0, 7.0])
def test_noise_is_the_documents(T):
    root = turn_noise(SV, SW, T)
    np.testing.assert_allclose(root @ root.T, noise(SV, SW, T), rtol=1e-14)
    assert turn_noise([SV, 1.0], SW, T).shape == (2, 5, 5)
    assert not turn_noise(SV, SW, 0.0).any()


# ---- the filters


def close(belief, m, P):
    """Equal to 1e-9 of the size of each state."""
    scale = 1.0 + np.sqrt(np.diag(P))
    np.testing.assert_allclose(belief.m / scale, m / scale, atol=1e-9)
    np.testing.assert_allclose(belief.P / np.outer(scale, scale), P / np.outer(scale, scale), atol=1e-9)


@pytest.mark.parametrize(('name', 'kappa'), [('ckf', 0.0), ('ukf', -2.0), ('ukf', 1.5)])
@given(seeds)
@settings(properties, max_examples=25)
def test_cubature_and_unscented_filters_are_the_dense_ones(name, kappa, seed):
    """Three steps of predict and update with whatever was heard; kappa = -2 is 3 - n."""
    belief, z = drawn(seed)
    m, P = belief.m, belief.P
    steps = filter_of(LossTolerantConfig(filter=name, kappa=kappa))
    for T in (0.3, 1.0, 2.0):
        belief = steps.update(steps.predict(belief, T), z, H, constant_noise(ANCHORS.sigma_db))
        m, P = dense_predict(m, P, lambda x, T=T: turned(x, T), noise(SV, SW, T), kappa)
        m, P = dense_update(m, P, z, H, R, kappa)
        close(belief, m, P)


@given(seeds)
@properties
def test_extended_filter_is_the_dense_one(seed):
    belief, z = drawn(seed)
    m, P = belief.m, belief.P
    steps = filter_of(LossTolerantConfig(filter='ekf'))
    for T in (0.3, 1.0):
        belief = steps.update(steps.predict(belief, T), z, H, constant_noise(ANCHORS.sigma_db))
        F = differences(lambda x, T=T: turned(x, T), m, np.array([1.0, 1.0, 1.0, 1.0, 1e-5]))
        m, P = turned(m, T), F @ P @ F.T + noise(SV, SW, T)
        heard = ~np.isnan(z)
        J = np.zeros((heard.sum(), 5))
        away = m[:2] - ANCHORS.positions[heard, :2]
        squared = np.sum(away**2, axis=1) + (1.0 - ANCHORS.positions[heard, 2]) ** 2
        J[:, :2] = -30.0 / np.log(10.0) * away / squared[:, None]
        S = J @ P @ J.T + R[np.ix_(heard, heard)]
        K = P @ J.T @ np.linalg.inv(S)
        m, P = m + K @ (z - H(m[None])[0])[heard], (np.eye(5) - K @ J) @ P
        scale = 1.0 + np.sqrt(np.diag(P))
        np.testing.assert_allclose(belief.m / scale, m / scale, atol=2e-6)  # of the differences of this test
        np.testing.assert_allclose(belief.P / np.outer(scale, scale), P / np.outer(scale, scale), atol=2e-6)
        m, P = belief.m, belief.P


@given(seeds)
@properties
def test_unscented_filter_of_kappa_0_is_the_cubature_filter(seed):
    belief, z = drawn(seed, 3)
    read = (z, H, constant_noise(ANCHORS.sigma_db))
    one, other = (filter_of(LossTolerantConfig(filter=name, kappa=0.0)) for name in ('ckf', 'ukf'))
    a, b = one.update(one.predict(belief, 1.0), *read), other.update(other.predict(belief, 1.0), *read)
    np.testing.assert_allclose(a.m, b.m, atol=1e-9)
    np.testing.assert_allclose(a.P, b.P, atol=1e-9)


@pytest.mark.parametrize('name', ['ckf', 'ekf', 'ukf'])
def test_a_batch_is_its_members(name):
    belief, z = drawn(5, 4, 3)
    steps, noise_ = filter_of(LossTolerantConfig(filter=name)), constant_noise(ANCHORS.sigma_db)
    whole = steps.update(steps.predict(belief, 1.3), z, H, noise_)
    for at in np.ndindex(4, 3):
        one = steps.update(steps.predict(Belief(belief.m[at], belief.chol_P[at]), 1.3), z[at], H, noise_)
        np.testing.assert_allclose(whole.m[at], one.m, rtol=1e-10)
        np.testing.assert_allclose(whole.chol_P[at], one.chol_P, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize('name', ['ckf', 'ekf', 'ukf'])
def test_lost_readings_are_as_if_their_nodes_were_not_there(name):
    belief, z = drawn(6)
    steps = filter_of(LossTolerantConfig(filter=name))
    heard = ~np.isnan(z)
    some = ANCHORS._make(column[heard] for column in ANCHORS)
    masked = steps.update(belief, z, H, constant_noise(ANCHORS.sigma_db))
    removed = steps.update(belief, z[heard], rssi_function(some, 1.0), constant_noise(some.sigma_db))
    np.testing.assert_allclose(masked.m, removed.m, atol=1e-12)
    np.testing.assert_allclose(masked.P, removed.P, atol=1e-12)


@pytest.mark.parametrize('name', ['ckf', 'ekf', 'ukf'])
def test_where_all_is_lost_the_prediction_stays(name):
    belief, z = drawn(7, 5)
    steps = filter_of(LossTolerantConfig(filter=name))
    after = steps.update(belief, np.full_like(z, np.nan), H, constant_noise(ANCHORS.sigma_db))
    np.testing.assert_array_equal(after.m, belief.m)
    np.testing.assert_allclose(after.chol_P, belief.chol_P, atol=1e-14)


@pytest.mark.parametrize('name', ['ckf', 'ekf', 'ukf'])
def test_no_time_changes_nothing(name):
    belief, _ = drawn(8)
    assert filter_of(LossTolerantConfig(filter=name)).predict(belief, 0.0) is belief


def test_a_prediction_stays_a_covariance_however_uncertain_the_turn():
    """Turn rates of which half a dozen turns fit into the step: 3 - n weighs the middle with less than nothing."""
    wild = Belief(np.array([0.0, 0.0, 3.0, 0.0, 0.1]), np.diag([50.0, 50.0, 9.0, 9.0, 4.0]))
    for kappa in (-2.0, 0.0, 3.0):
        after = turning.predict(wild, lambda x: coordinated_turn(x, 30.0), turn_noise(SV, SW, 30.0), 2, kappa)
        assert np.linalg.eigvalsh(after.P)[0] > 0.0
        assert np.all(np.isfinite(after.m))


def test_slopes_of_readings_are_their_derivatives():
    anchors = ANCHORS._replace(scale=np.full(9, 1.07), bias=np.full(9, 0.2))
    m = drawn(9, 20)[0].m
    away = m[:, None, :2] - anchors.positions[:, :2]
    d = np.sqrt(np.sum(away**2, axis=-1) + (1.0 - anchors.positions[:, 2]) ** 2)
    ranged = linearised.slope(range_function(anchors, 1.0), m, 2)
    heard = linearised.slope(rssi_function(anchors, 1.0), m, 2)
    np.testing.assert_allclose(ranged, 1.07 * away / d[..., None], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(heard, -30.0 / np.log(10.0) * away / (d * d)[..., None], rtol=1e-6, atol=1e-9)


# ---- what is beside them


def test_holding_repeats_the_last_value():
    nan = np.nan
    z = np.array([[nan, 1.0], [2.0, nan], [nan, nan], [4.0, 5.0], [nan, nan]])
    kept = [[nan, 1.0], [2.0, 1.0], [2.0, 1.0], [4.0, 5.0], [4.0, 5.0]]
    np.testing.assert_array_equal(held(z), kept)
    np.testing.assert_array_equal(held(np.stack([z, z[::-1]]))[0], kept)


def test_a_turn_rate_joins_a_planar_belief():
    planar = Belief(np.arange(8.0).reshape(2, 4), np.broadcast_to(np.eye(4), (2, 4, 4)))
    wider = with_turn(planar, 0.3)
    np.testing.assert_array_equal(wider.m[:, :4], planar.m)
    np.testing.assert_allclose(wider.P[1], np.diag([1.0, 1.0, 1.0, 1.0, 0.09]))
    assert not wider.m[:, 4].any()


@pytest.mark.parametrize(
    ('config', 'words'),
    [
        (LossTolerantConfig(area=(0.0, 0.0, 0.0, 1.0)), 'area'),
        (LossTolerantConfig(start=TurningStartConfig(mean=(0.0,) * 5)), 'take four numbers each'),
        (LossTolerantConfig(turn=TurnConfig(acceleration_std=0.0)), 'stops listening'),
    ],
)
def test_a_configuration_that_cannot_track_is_refused(config, words):
    with pytest.raises(TrackingError, match=words):
        config.checked()
