"""The filters of system E step by step, batched: cubature, and the extended and the unscented one beside it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wsn_tracking.filters import linearised, srckf, turning
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import POSITION, Function
from wsn_tracking.models.motion import coordinated_turn, turn_jacobian
from wsn_tracking.models.noise import turn_noise
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig


class Filter(NamedTuple):
    """One way to predict and to update a belief over [x, y, vx, vy, w]."""

    predict: Callable[[Belief, float], Belief]  # by so many seconds
    regress: Callable[[Belief, Function], Regression]  # what the nodes should read, as linear about the belief
    update: Callable[[Belief, Floats, Function, Function], Belief]  # with z (..., N), NaN where lost, h and noise


def filter_of(config: LossTolerantConfig) -> Filter:
    """The filter of these parameters; `hold` is the cubature filter, fed otherwise."""
    if config.filter == 'ekf':
        return _extended(config)
    return _unscented(config, config.kappa if config.filter == 'ukf' else 0.0)


def _unscented(config: LossTolerantConfig, kappa: float) -> Filter:
    def predict(belief: Belief, dt: float) -> Belief:
        return turning.predict(belief, lambda x: coordinated_turn(x, dt), _noise(config, dt), POSITION, kappa)

    return Filter(
        _forward(predict),
        lambda belief, h: srckf.predicted_readings(belief, belief, h, kappa, 0, POSITION),
        lambda belief, z, h, noise: srckf.update(belief, z, h, noise, 1, kappa, 0, POSITION),
    )


def _extended(config: LossTolerantConfig) -> Filter:
    def predict(belief: Belief, dt: float) -> Belief:
        return linearised.predict(
            belief, lambda x: coordinated_turn(x, dt), lambda x: turn_jacobian(x, dt), _noise(config, dt)
        )

    return Filter(
        _forward(predict),
        lambda belief, h: linearised.tangent(h, belief, POSITION),
        lambda belief, z, h, noise: linearised.update(belief, z, h, noise, POSITION),
    )


def _forward(predict: Callable[[Belief, float], Belief]) -> Callable[[Belief, float], Belief]:
    """The same, which leaves a belief as it is where no time has passed."""
    return lambda belief, dt: predict(belief, dt) if dt > 0.0 else belief


def _noise(config: LossTolerantConfig, dt: float) -> Floats:
    return turn_noise(config.turn.acceleration_std, math.radians(config.turn.turn_std), dt)


def with_turn(planar: Belief, turn_std: float) -> Belief:
    """A belief over [x, y, vx, vy] with the turn rate N(0, turn_std^2) [rad/s] behind it."""
    m, chol_P = planar
    wider = np.zeros((*m.shape[:-1], 5, 5))
    wider[..., :4, :4], wider[..., 4, 4] = chol_P, turn_std
    return Belief(np.concatenate([m, np.zeros((*m.shape[:-1], 1))], axis=-1), wider)


def held(z: Floats) -> Floats:
    """z (..., K, N) with the last value for what was lost; NaN before the first."""
    at = np.where(np.isnan(z), 0, np.arange(z.shape[-2])[:, None])
    return np.take_along_axis(z, np.maximum.accumulate(at, axis=-2), axis=-2)
