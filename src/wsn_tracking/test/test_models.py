import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, covariances, properties, small_anchors

from wsn_tracking.errors import TrackingError
from wsn_tracking.models import measurement
from wsn_tracking.models.anchors import Anchors, check, make_anchors
from wsn_tracking.models.draws import Stream, keyed
from wsn_tracking.models.motion import constant_velocity, forgetful_velocity
from wsn_tracking.models.noise import scaled_identity, white_acceleration
from wsn_tracking.models.radio import MIN_RANGE, range_at, relative_range_std, rssi_at

steps = st.floats(1e-3, 20.0)
densities = st.floats(1e-6, 10.0)


def covariance_of(root):
    return root @ np.swapaxes(root, -1, -2)


# --- motion and its noise


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


# --- radio


@properties
@given(st.floats(0.02, 500.0), st.floats(1.5, 6.0), st.floats(-80.0, -20.0), st.floats(0.1, 10.0))
def test_range_and_rssi_are_each_others_inverse(distance, n, p1_dbm, d0):
    anchors = small_anchors(n=[n, 2.0, 4.0], p1_dbm=p1_dbm, d0=d0)
    d = distance * np.array([1.0, 0.5, 2.0])
    np.testing.assert_allclose(range_at(anchors, rssi_at(anchors, d)), np.maximum(d, MIN_RANGE), rtol=1e-11)


def test_the_documents_radio():
    anchors = LOOP.anchors
    assert rssi_at(anchors, np.full(12, 1.0)) == pytest.approx(-45.0)
    assert rssi_at(anchors, np.full(12, 10.0)) == pytest.approx(-75.0)
    assert range_at(anchors, np.full(12, -55.0)) == pytest.approx(10.0 ** (1.0 / 3.0))  # the service radius, 2.15 m
    assert relative_range_std(anchors) == pytest.approx(0.12, abs=5e-4)


def test_no_range_and_no_distance_is_below_the_radios_resolution():
    anchors = small_anchors()
    assert np.all(range_at(anchors, np.full(3, 200.0)) == MIN_RANGE)
    np.testing.assert_array_equal(rssi_at(anchors, np.zeros(3)), rssi_at(anchors, np.full(3, MIN_RANGE)))
    on_top = np.array([[0.0, 0.0, 0.0, 0.0]])
    assert measurement.distances(anchors, on_top, height=1.0)[0, 2] == MIN_RANGE


@pytest.mark.filterwarnings('error')
def test_no_range_is_beyond_what_can_be_squared():
    waveguide = make_anchors([1], [[0.0, 0.0]], n=0.01)
    assert np.square(np.square(range_at(waveguide, [-127.0]))) < np.inf


@properties
@given(st.floats(0.2, 6.0), st.floats(1.5, 6.0))
def test_scatter_in_decibel_is_an_even_scatter_of_the_logarithm_of_the_range(sigma_db, n):
    anchors = small_anchors(sigma_db=sigma_db, n=n)
    rssi = rssi_at(anchors, np.array([1.0, 4.0, 9.0]))
    shift = np.log(range_at(anchors, rssi - sigma_db)) - np.log(range_at(anchors, rssi))
    np.testing.assert_allclose(shift, relative_range_std(anchors), rtol=1e-9)


# --- measurement functions


def test_distances_are_three_dimensional():
    anchors = small_anchors()
    states = np.array([[2.0, 3.0, 9.0, 9.0], [0.0, 0.0, 0.0, 0.0]])
    expected = np.linalg.norm(np.array([[2.0, 3.0, 0.4], [0.0, 0.0, 0.4]])[:, None] - anchors.positions, axis=-1)
    np.testing.assert_allclose(measurement.distances(anchors, states, height=0.4), expected)


def test_functions_of_a_calibrated_radio():
    anchors = small_anchors(scale=[1.1, 1.0, 0.9], bias=[0.2, 0.0, -0.1])
    x = np.random.default_rng(1).random((2, 5, 4))
    d = measurement.distances(anchors, x, 0.3)
    h = measurement.range_function(anchors, 0.3)
    np.testing.assert_allclose(h(x), anchors.scale * d + anchors.bias)
    np.testing.assert_allclose(measurement.log_range_function(anchors, 0.3)(x), np.log(h(x)))
    np.testing.assert_allclose(measurement.rssi_function(anchors, 0.3)(x), rssi_at(anchors, d))
    np.testing.assert_allclose(measurement.relative_noise(anchors, h)(x), relative_range_std(anchors) * h(x))
    assert measurement.constant_noise(np.ones((2, 3)))(x).shape == (2, 1, 3)


# --- draws


def test_a_draw_does_not_depend_on_what_was_drawn_before():
    keys = [(seed, who, epoch) for seed in (0, 3) for who in (1, 2**32) for epoch in (0, 1, 500)]
    forward = {key: keyed(*key).random(3).tolist() for key in keys}
    backward = {key: keyed(*key).random(3).tolist() for key in reversed(keys)}
    assert forward == backward


def test_a_stream_gives_each_epochs_draws_in_whatever_order():
    for seed, who in [(0, 1), (7, 2**33 + 3), (2**63 + 1, 2**64 - 1), (-1, 5)]:
        stream = Stream(seed, who)
        for epoch in (3, 0, 3, 2**40, 1, 1):
            np.testing.assert_array_equal(stream.at(epoch).random(9), keyed(seed, who, epoch).random(9))
            assert stream.at(epoch).uniform(2.0, 12.0) == keyed(seed, who, epoch).uniform(2.0, 12.0)


def test_seeds_drawers_and_epochs_have_streams_of_their_own():
    keys = [(s, w, e) for s in range(4) for w in (*range(6), 2**32, 2**33) for e in (*range(6), 2**40)]
    firsts = {keyed(*key).random() for key in keys}
    assert len(firsts) == len(keys)
    assert keyed(-1, 1, 1).random() != keyed(1, 1, 1).random()


@pytest.mark.parametrize('axis', [0, 1, 2])
def test_first_draws_are_uniform_and_uncorrelated_along_every_key(axis):
    stats = pytest.importorskip('scipy.stats')
    keys = np.ones((4000, 3), dtype=int)
    keys[:, axis] = np.arange(4000)
    u = np.array([keyed(*key).random() for key in keys.tolist()])
    assert stats.kstest(u, 'uniform').pvalue > 0.01
    # the correlation of independent neighbours has the standard deviation 1/sqrt(4000) = 0.016
    assert abs(np.corrcoef(u[1:], u[:-1])[0, 1]) < 0.05


# --- the table of nodes


def test_rows_ascend_by_id_with_their_columns():
    anchors = small_anchors(n=[7.0, 3.0, 5.0])
    assert anchors.ids.tolist() == [3, 5, 7]
    assert anchors.n.tolist() == [3.0, 5.0, 7.0]
    assert anchors.positions[:, 2].tolist() == [0.5, 0.0, 1.0]
    assert anchors.rows([7, 4, 3, 900]).tolist() == [2, -1, 0, -1]
    assert anchors.rows([]).tolist() == []
    nobody = Anchors._make(column[:0] for column in anchors)
    assert nobody.rows([3]).tolist() == [-1]


def test_flat_positions_lie_on_the_floor():
    assert make_anchors([1, 2], [[1.0, 2.0], [3.0, 4.0]]).positions[:, 2].tolist() == [0.0, 0.0]


def test_select_keeps_some_nodes_and_refuses_unknown_ones():
    anchors = small_anchors(sigma_db=[1.0, 2.0, 3.0])
    some = anchors.select([7, 3])
    assert some.ids.tolist() == [3, 7]
    assert some.sigma_db.tolist() == [2.0, 1.0]
    with pytest.raises(TrackingError, match=r'nodes \[4\] are not among the anchors \[3, 5, 7\]'):
        anchors.select([3, 4])


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        ({'ids': np.array([1, 2, 2])}, r'ids \[2\] occur more than once'),
        ({'ids': np.array([-1, 2, 3])}, r'leave 0\.\.65535'),
        ({'ids': np.array([1, 2, 65536])}, r'leave 0\.\.65535'),
        ({'positions': np.zeros((3, 2))}, r'shape \(3, 2\), expected \(N, 3\)'),
        ({'bias': np.array([0.0, np.nan, 0.0])}, '`bias` holds NaN or infinity'),
        ({'n': np.array([3.0, 0.0, 3.0])}, r'`n` holds 0\.0: expected 0\.01 to 20'),
        ({'p1_dbm': np.array([-40.0, 1e300, -40.0])}, '`p1_dbm` holds 1e\\+300: expected -200 to 100'),
        ({'positions': np.full((3, 3), -2e8)}, r'positions go up to 2e\+08 m: expected 1e\+08 m at most'),
        ({'sigma_db': np.array([-1.0, 1.0, 1.0])}, '`sigma_db` holds -1.0'),
        ({'d0': np.array([1.0, 1.0, np.inf])}, '`d0` holds NaN or infinity'),
        ({'scale': np.array([1.0, 0.0, 1.0])}, '`scale` holds 0.0'),
    ],
)
def test_a_table_that_no_filter_may_use_is_refused(change, message):
    with pytest.raises(TrackingError, match=message):
        check(small_anchors()._replace(**change))


def test_an_empty_table_and_an_unknown_column_are_refused():
    with pytest.raises(TrackingError, match='the anchors hold no node'):
        make_anchors([], np.zeros((0, 3)))
    with pytest.raises(TrackingError, match='the anchors hold no node'):
        check(Anchors._make(column[:0] for column in small_anchors()))
    with pytest.raises(TypeError, match='power'):
        make_anchors([1], [[0.0, 0.0]], power=3.0)


@pytest.mark.parametrize('positions', [np.zeros((2, 3)), np.zeros((3, 4)), np.zeros(6)])
def test_positions_of_another_number_of_nodes_are_refused(positions):
    with pytest.raises(TrackingError, match='3 anchors have positions of shape'):
        make_anchors([1, 2, 3], positions)


def test_covariances_of_the_oracle_are_covariances():
    P = covariances(np.random.default_rng(0), 5, 2, condition=1e6)
    assert P.shape == (5, 2, 4, 4)
    assert np.linalg.eigvalsh(P).min() > 0.0
