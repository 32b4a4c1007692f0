"""Seed 004: filters on a turning target whose reports get lost, by how many are."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.links import Loss, gamma
from wsn_tracking.models.motion import turn_jacobian
from wsn_tracking.models.noise import turn_noise
from wsn_tracking.models.radio import relative_range_std
from wsn_tracking.reproduction.bounds import path_bound, scalar_information
from wsn_tracking.reproduction.claims import Experiment, Samples
from wsn_tracking.simulation.e_loss import PERIOD, anchors_of
from wsn_tracking.studies import loss_runs
from wsn_tracking.studies.loss import FILTERS, LOST, squares
from wsn_tracking.studies.loss_runs import Worlds
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig

RATES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9)


def sweep(seed: int, runs: int) -> Samples:
    """Every filter at every loss rate, over the same walks and noise."""
    worlds = loss_runs.sample(runs, seed)
    samples: dict[str, Floats] = {}
    for p in RATES:
        arrived = gamma(Loss(p), worlds.uniform)
        samples[f'bound {p:g}'] = least(worlds, arrived.astype(np.float64))
        samples[f'messages {p:g}'] = arrived.sum(axis=-1).mean(axis=-1)
        for name in FILTERS:
            scores = loss_runs.track(worlds, LossTolerantConfig(filter=name), Loss(p))
            samples[f'{name} {p:g}: squares'] = squares(scores)
            samples[f'{name} {p:g}: nees'] = np.asarray(scores.nees.mean(axis=-1))
            samples[f'{name} {p:g}: lost'] = np.asarray(
                np.hypot(scores.errors[:, -1, 0], scores.errors[:, -1, 1]) > LOST, dtype=np.float64
            )
    return samples


def least(worlds: Worlds, arrived: Floats) -> Floats:
    """Mean squared error (runs,) [m^2] of a filter with the noise of the others that is linearised at the truth."""
    anchors, turn = anchors_of(worlds.config), LossTolerantConfig().turn
    root = turn_noise(turn.acceleration_std, np.radians(turn.turn_std), PERIOD)
    weights = arrived / relative_range_std(anchors) ** 2
    information = scalar_information(anchors.positions, worlds.states, weights, inverse_distance=True)
    F = turn_jacobian(worlds.states, PERIOD)
    P = path_bound(np.diag(np.square(loss_runs.START_STD)), F, root @ root.T, information)
    return np.asarray(np.trace(P[..., :2, :2], axis1=-2, axis2=-1).mean(axis=-1))


SWEEP = Experiment('e sweep', sweep, runs=50, units=16, quick=6)
