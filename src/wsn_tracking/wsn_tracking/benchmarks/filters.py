"""One predict and update of a cubature filter, 4 states, 5 of 12 ranges: ours, filterpy's and Stone Soup's."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from datetime import datetime, timedelta
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, cpu_seconds
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.srckf import predict, update
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import POSITION, Function, constant_noise, range_function
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import scaled_identity
from wsn_tracking.simulation.scenarios import scenario

GROUP, WORK = 'filter', 'SRCKF predict + update'
HEARD = 5  # of the twelve nodes
SINGLE = {'filterpy': 3.2, 'Stone Soup': 16.0}  # goals
BATCHED = {3: 10.0, 100: 55.0, 1000: 160.0}

Step = Callable[[], Belief]


class Problem(NamedTuple):
    """What every contender is given."""

    belief: Belief  # (..., 4)
    F: Floats
    chol_Q: Floats
    z: Floats  # (..., 12), NaN where not heard
    std: Floats  # (..., 12)
    h: Function
    positions: Floats  # (12, 2)


def problem(*batch: int, q: float = 7.0, seed: int = 1) -> Problem:
    """Beliefs in the field of scenario L, and ranges of other nodes to each."""
    rng, field = np.random.default_rng(seed), scenario('a_loop')
    m = np.array([1.5, 1.0, 0.05, 0.02]) + 0.05 * rng.standard_normal((*batch, 4))
    chol_P = np.broadcast_to(np.diag([0.1, 0.1, 0.06, 0.06]), (*batch, 4, 4))
    h, F = range_function(field.anchors), constant_velocity(1.0)
    z = h(m[..., None, :])[..., 0, :] * (1.0 + 0.12 * rng.standard_normal((*batch, 12)))
    z = np.where(rng.permuted(np.broadcast_to(np.arange(12), z.shape), axis=-1) < HEARD, z, np.nan)
    return Problem(Belief(m, chol_P), F, scaled_identity(q), z, 0.12 * z, h, field.anchors.positions[:, :2])


def ours(p: Problem, form: str = 'gram') -> Step:
    """Ours, for one belief or a batch."""
    noise = constant_noise(p.std)

    def step() -> Belief:
        return update(predict(p.belief, p.F, p.chol_Q, form), p.z, p.h, noise, seen=POSITION, form=form)

    return step


def filterpy(p: Problem) -> Step:
    """filterpy's, which leaves the process noise out of the innovation: equal to ours where there is none."""
    from filterpy.kalman import CubatureKalmanFilter

    rows = np.flatnonzero(~np.isnan(p.z))
    z, positions = p.z[rows, None], p.positions[rows]
    peer = CubatureKalmanFilter(
        4, rows.size, 1.0, hx=lambda x: np.hypot(*(positions - x[:2]).T), fx=lambda x, dt: p.F @ x
    )
    peer.Q, peer.R = p.chol_Q @ p.chol_Q.T, np.diag(p.std[rows] ** 2)
    m, P = p.belief.m[:, None], p.belief.P

    def step() -> Belief:
        peer.x, peer.P = m, P
        peer.predict()
        peer.update(z)
        return Belief(peer.x[:, 0], np.linalg.cholesky(peer.P))

    return step


def stone_soup(p: Problem) -> Step:
    """Stone Soup's, with its usual objects round each step."""
    from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
    from stonesoup.predictor.kalman import CubatureKalmanPredictor
    from stonesoup.types.array import StateVector
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import CubatureKalmanUpdater

    rows = np.flatnonzero(~np.isnan(p.z))
    model = _stone_soup_ranges(p.positions[rows], p.std[rows])
    motion = LinearGaussianTimeInvariantTransitionModel(transition_matrix=p.F, covariance_matrix=p.chol_Q @ p.chol_Q.T)
    predictor, updater = CubatureKalmanPredictor(motion), CubatureKalmanUpdater(model)
    then = datetime(2026, 1, 1)  # noqa: DTZ001 (Stone Soup compares with naive stamps)
    now = then + timedelta(seconds=1)

    def step() -> Belief:
        prior = GaussianState(p.belief.m, p.belief.P, timestamp=then)  # a new one: it remembers what was done to an old
        detection = Detection(StateVector(p.z[rows]), timestamp=now, measurement_model=model)
        posterior = updater.update(SingleHypothesis(predictor.predict(prior, timestamp=now), detection))
        return Belief(np.ravel(posterior.state_vector).astype(float), np.linalg.cholesky(posterior.covar))

    return step


def _stone_soup_ranges(positions: Floats, std: Floats) -> Any:
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.types.array import StateVector, StateVectors

    class Ranges(NonLinearGaussianMeasurement):  # type: ignore[misc]
        """Distances to the nodes that were heard; Stone Soup's states are columns."""

        @property
        def ndim_meas(self) -> int:
            return len(self.covar())

        def function(self, state: Any, noise: bool = False, **kwargs: Any) -> Any:
            columns = np.asarray(state.state_vector, dtype=float)[:POSITION]
            d = np.hypot(*(columns[:, None, :] - positions.T[:, :, None]))
            return (StateVector if d.shape[-1] == 1 else StateVectors)(d)

    return Ranges(ndim_state=4, mapping=(0, 1), noise_covar=np.diag(std**2))


PEERS: dict[str, Callable[[Problem], Step]] = {'filterpy': filterpy, 'Stone Soup': stone_soup}


def rows(sizes: Sizes) -> Iterable[Row]:
    """Ours against each peer, one by one and in batches (the peers know none)."""
    single, missing = problem(), {}
    contenders: dict[str, Step] = {'ours': ours(single), 'qr': ours(single, 'qr')}
    for name, make in PEERS.items():
        try:
            contenders[name] = make(single)
        except ImportError as error:
            missing[name] = f'not installed ({error.name})'
    contenders |= {str(batch): ours(problem(batch)) for batch in sizes.batches}
    took = {name: 1e6 * seconds for name, seconds in cpu_seconds(contenders, sizes).items()}
    for name, goal in SINGLE.items():
        note = missing.get(name, '')
        yield Row(GROUP, WORK, 'us', took['ours'], name, took.get(name), at_least(goal, ratio=True), note=note)
    yield Row(GROUP, WORK, 'us', took['ours'], 'QR form', took['qr'])
    for batch in sizes.batches:
        goal_of = BATCHED.get(batch)
        yield Row(
            GROUP,
            f'{WORK}, per filter of {batch}',
            'us',
            took[str(batch)] / batch,
            'filterpy',
            took.get('filterpy'),
            None if goal_of is None else at_least(goal_of, ratio=True),
            note=missing.get('filterpy', ''),
        )
