"""The square-root filter against textbooks and Stone Soup."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from belief_cases import F, close, drawn, forms, heard
from hypothesis import given
from hypothesis import strategies as st
from oracles import LOOP, NOISE, H, beliefs, covariances, dense_ckf, dense_iplf, kalman, properties, seeds

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import transpose
from wsn_tracking.filters.srckf import predict, update
from wsn_tracking.models.measurement import constant_noise
from wsn_tracking.models.noise import white_acceleration


@properties
@given(seeds, st.integers(1, 4), forms)
def test_iplf_is_the_textbooks(seed, passes, form):
    belief, z = drawn(seed, silent=0.4)
    some, h, noise = heard(z)
    m, P = dense_iplf(belief.m, belief.P, some, h, noise, passes)
    close(update(belief, z, H, NOISE, passes, form=form), m, P, 1e-7)


@properties
@given(seeds)
def test_iplf_of_one_pass_is_the_ckf(seed):
    belief, z = drawn(seed)
    some, h, noise = heard(z)
    m, P = dense_ckf(belief.m, belief.P, some, h, np.diag(noise(belief.m[None])[0] ** 2))
    close(update(belief, z, H, NOISE, 1), m, P, 1e-9)


@properties
@given(seeds, st.integers(1, 5))
def test_every_pass_on_a_linear_measurement_is_the_kalman_update(seed, passes):
    rng = np.random.default_rng(seed)
    A, b = rng.standard_normal((6, 4)), rng.standard_normal(6)
    P, std, m = covariances(rng), rng.uniform(0.1, 2.0, 6), rng.standard_normal(4)
    z = rng.standard_normal(6)
    after = update(Belief(m, np.linalg.cholesky(P)), z, lambda x: x @ A.T + b, constant_noise(std), passes)
    close(after, *kalman(m, P, z - b, A, np.diag(std**2)), 1e-8)


@properties
@given(seeds)
def test_prediction_is_the_linear_time_update(seed):
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, 2, 3)
    A, root_Q = rng.standard_normal((4, 4)), rng.standard_normal((3, 4, 4))
    after = predict(Belief(m, np.linalg.cholesky(P)), A, root_Q)
    np.testing.assert_allclose(after.m, m @ A.T, rtol=1e-10, atol=1e-12)
    fanned = predict(Belief(m[0, 0], np.linalg.cholesky(P[0, 0])), A, root_Q)
    assert (fanned.m.shape, fanned.chol_P.shape) == ((3, 4), (3, 4, 4))
    np.testing.assert_allclose(after.P, A @ P @ A.T + root_Q @ transpose(root_Q), rtol=1e-9, atol=1e-10)


def test_stone_soups_cubature_filter_agrees():
    """In the same order of states: another order has other cubature points, and a result that is 1e-5 m away."""
    pytest.importorskip('stonesoup')
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.kalman import CubatureKalmanPredictor
    from stonesoup.types.array import StateVector, StateVectors
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import CubatureKalmanUpdater

    class Ranges(NonLinearGaussianMeasurement):
        """Distances to the nodes that were heard; Stone Soup's states are columns."""

        @property
        def ndim_meas(self):
            return len(self.covar())

        def function(self, state, noise=False, **kwargs):
            columns = H(np.asarray(state.state_vector, dtype=float).T)[..., nodes].T
            return (StateVector if columns.shape[-1] == 1 else StateVectors)(columns)

    rng, clock, root_Q = np.random.default_rng(8), datetime(2026, 1, 1), white_acceleration(1.6e-3, 1.0)  # noqa: DTZ001
    motion = LinearGaussianTimeInvariantTransitionModel(transition_matrix=F, covariance_matrix=root_Q @ root_Q.T)
    belief = Belief(LOOP.truth[0] + 0.05, np.diag([0.1, 0.1, 0.06, 0.06]))
    peer = GaussianState(belief.m, belief.P, timestamp=clock)
    for k in range(1, 31):
        nodes = np.sort(rng.permutation(12)[:5])
        z = np.full(12, np.nan)
        z[nodes] = H(LOOP.truth[k])[nodes] * (1.0 + 0.12 * rng.standard_normal(5))
        belief = update(predict(belief, F, root_Q), z, H, constant_noise(0.12 * z))
        model = Ranges(ndim_state=4, mapping=(0, 1), noise_covar=np.diag((0.12 * z[nodes]) ** 2))
        prediction = CubatureKalmanPredictor(motion).predict(peer, timestamp=clock + timedelta(seconds=k))
        detection = Detection(StateVector(z[nodes]), timestamp=prediction.timestamp, measurement_model=model)
        peer = CubatureKalmanUpdater(model).update(SingleHypothesis(prediction, detection))
        np.testing.assert_allclose(belief.m, np.ravel(peer.state_vector).astype(float), rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(belief.P, peer.covar, rtol=0.0, atol=1e-10)
