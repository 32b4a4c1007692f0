"""System A over many runs at once: the functions that the nodes run, with leading axes (runs, estimators).

Variants are compared over the same `Sensed`, the same start and the same `uniform` draws, so that their difference
is theirs alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.evaluation.metrics import nees, position_errors
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import matvec
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing.trigger import SENT, Trigger, Verdicts
from wsn_tracking.sensing.values import Reason
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import noisy_ranges
from wsn_tracking.trackers.fusing import RULES
from wsn_tracking.trackers.random_q import random_q_step
from wsn_tracking.trackers.random_q_config import RandomQConfig
from wsn_tracking.trackers.readings import MeasurementTable

START_STD = (0.1, 0.1, 0.06, 0.06)  # roots of P0 for x, y, vx, vy [m, m/s]
MIDDLE = np.full((1, 1, 1), 0.5)


class Sensed(NamedTuple):
    """What the sensing nodes made of every run."""

    states: Floats  # (runs, K, 4) where the target was
    z: Floats  # (runs, K, N) ranges that were sent [m]; NaN where a node stayed silent
    verdicts: Verdicts  # (runs, K, N): trigger.SENT, or why not


class Tracks(NamedTuple):
    """What every run's estimators made of it."""

    m: Floats  # (runs, estimators, K, 4)
    P: Floats  # (runs, estimators, K, 4, 4)


def sense(scenario: Scenario, states: Floats, trigger: Trigger, generator: np.random.Generator) -> Sensed:
    """Noisy ranges to states (runs, K, 4), their signal strengths, and what the trigger lets through."""
    z = noisy_ranges(scenario, states, generator.standard_normal((*states.shape[:-1], scenario.anchors.ids.size)))
    uniform = generator.random(z.shape)
    y = rssi_at(scenario.anchors, z)
    verdicts = np.zeros(z.shape, dtype=np.int64)
    yhat = np.full(y[..., 0, :].shape, np.nan)
    for k in range(z.shape[-2]):
        yhat, verdicts[..., k, :] = trigger(yhat, y[..., k, :], uniform[..., k, :])
    return Sensed(states, np.where(verdicts == SENT, z, np.nan), verdicts)


def in_radius(sensed: Sensed) -> Mask:
    """Where eq. 1 let a signal through, sent or not, (runs, K, N)."""
    return np.isin(sensed.verdicts, (SENT, Reason.UNCHANGED, Reason.NOISY))


def repeated(scenario: Scenario, runs: int) -> Floats:
    """The scenario's own walk in every run, (runs, K, 4)."""
    return np.broadcast_to(scenario.truth, (runs, *scenario.truth.shape))


def walks_inside(
    scenario: Scenario, spectral_density: float, epochs: int, runs: int, generator: np.random.Generator
) -> Floats:
    """Walks (runs, K, 4) of white acceleration [m^2/s^3] from the middle of the area that never leave it.

    They start at the middle with N(0, (6 cm/s)^2) per axis; a walk that leaves the area is drawn anew. Keep K small
    against the time to the border, or what is left is no longer the model.
    """
    x_min, y_min, x_max, y_max = scenario.area
    F, chol_Q = constant_velocity(scenario.period), white_acceleration(spectral_density, scenario.period)
    kept = np.empty((0, epochs, 4))
    while len(kept) < runs:
        x = np.empty((runs, epochs, 4))
        x[:, 0] = (0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0, 0.0)
        x[:, 0, 2:] += 0.06 * generator.standard_normal((runs, 2))
        for k in range(1, epochs):
            x[:, k] = matvec(F, x[:, k - 1]) + matvec(chol_Q, generator.standard_normal((runs, 4)))
        low, high = np.array([x_min, y_min]), np.array([x_max, y_max])
        inside = np.all((x[..., :2] >= low) & (x[..., :2] <= high), axis=(-1, -2))
        kept = np.concatenate([kept, x[inside]])
    return kept[:runs]


def start_near(states: Floats, generator: np.random.Generator, std: ArrayLike = START_STD) -> Belief:
    """x0 ~ N(truth, P0) about the first of states (..., K, 4), the same P0 in every run."""
    root = np.asarray(std, dtype=np.float64)
    first = states[..., 0, :]
    m = first + root * generator.standard_normal(first.shape)
    return Belief(m, np.broadcast_to(np.diag(root), (*m.shape, root.size)))


def track(scenario: Scenario, sensed: Sensed, start: Belief, config: RandomQConfig, uniform: Floats = MIDDLE) -> Tracks:
    """Filter every run with every estimator of it.

    start (runs, 4) is the belief before the update of the first epoch; uniform (runs, estimators, K), or what
    broadcasts to it, places q between q_min (0) and q_max (1): one estimator with the mean of both by default.
    """
    runs, epochs = sensed.z.shape[:2]
    batch = (runs, uniform.shape[1])
    u = np.broadcast_to(uniform, (*batch, epochs))
    q = config.noise.q_min + (config.noise.q_max - config.noise.q_min) * u
    z = sensed.z[:, None]
    unknown = np.full_like(z[..., 0, :], np.nan)
    table = MeasurementTable(scenario.anchors, config.target_height, config.update)
    m, P = np.empty((*batch, epochs, 4)), np.empty((*batch, epochs, 4, 4))
    belief = Belief(
        np.broadcast_to(start.m[:, None], m[..., 0, :].shape),
        np.broadcast_to(start.chol_P[:, None], P[..., 0, :, :].shape),
    )
    for k in range(epochs):
        given = table.ranges(z[..., k, :], unknown, from_rssi=True)
        belief = random_q_step(belief, scenario.period if k else 0.0, q[..., k], *given, config)
        m[..., k, :], P[..., k, :, :] = belief.m, belief.P
    return Tracks(m, P)


def fuse(tracks: Tracks, rule: str) -> Tracks:
    """What the estimators of every run make of each other: one estimate more, (runs, 1, K, 4), its P where told.

    The recursion of LCI starts at P0 = diag(START_STD^2).
    """
    m, P = np.moveaxis(tracks.m, 1, -2), np.moveaxis(tracks.P, 1, -3)
    if rule != 'lci':
        fused = RULES[rule](m, P)
        return Tracks(fused.m[:, None], fused.P[:, None])
    spread = np.broadcast_to(np.diag(np.square(START_STD)), P[:, 0].shape)
    steps = []
    for k in range(m.shape[1]):
        spread = ci.spread(spread, m[:, k])
        steps.append(ci.lci(m[:, k], spread))
    return Tracks(np.stack([s.m for s in steps], axis=1)[:, None], np.stack([s.P for s in steps], axis=1)[:, None])


def errors(tracks: Tracks, sensed: Sensed) -> Floats:
    """Estimate minus truth in the plane, (runs, estimators, K, 2) [m]."""
    return position_errors(tracks.m, sensed.states[:, None])


def position_nees(tracks: Tracks, sensed: Sensed) -> Floats:
    """NEES of the 2-D position, (runs, estimators, K); 2 on the average is consistent."""
    return nees(errors(tracks, sensed), tracks.P[..., :2, :2])
