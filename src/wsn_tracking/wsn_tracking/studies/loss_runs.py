"""System E over many runs at once: walks, signal strengths and losses are drawn, every filter tracks the same.

Variants are compared over the same `Worlds`, whose losses are nested: what is lost at one rate is lost at a higher one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.evaluation.metrics import nees, position_errors
from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.links import Loss, gamma
from wsn_tracking.models.measurement import constant_noise, rssi_function
from wsn_tracking.simulation import e_loss
from wsn_tracking.simulation.e_loss import LossConfig
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig
from wsn_tracking.trackers.turning import filter_of, held

START_STD = (5.0, 5.0, 2.0, 2.0, float(np.radians(3.0)))  # roots of P0 [m, m/s, rad/s]


class Worlds(NamedTuple):
    """What happened in every run, but for the losses."""

    config: LossConfig
    states: Floats  # (runs, K, 5)
    normals: Floats  # (runs, K, N)
    uniform: Floats  # (runs, K, N) draws that decide what is lost
    start: Belief  # (runs, 5) before the first epoch's update


class Scores(NamedTuple):
    """How every run went."""

    errors: Floats  # (runs, K, 2) [m]
    nees: Floats  # (runs, K) of the 2-D position: 2 on the average is consistent


def sample(runs: int, seed: int, config: LossConfig | None = None) -> Worlds:
    """Draw runs of the scenario; x0 ~ N(truth, P0)."""
    config = config or LossConfig()
    generator = np.random.default_rng(seed)
    states = e_loss.walks(config, generator.random((runs, e_loss.legs(config), 2)))
    shape = (*states.shape[:2], e_loss.anchors_of(config).ids.size)
    normals, uniform = generator.standard_normal(shape), generator.random(shape)
    root = np.array(START_STD)
    m = states[:, 0] * [1.0, 1.0, 1.0, 1.0, 0.0] + root * generator.standard_normal((runs, 5))
    return Worlds(config, states, normals, uniform, Belief(m, np.broadcast_to(np.diag(root), (runs, 5, 5))))


def track(worlds: Worlds, config: LossTolerantConfig, loss: Loss) -> Scores:
    """One filter through all runs."""
    anchors = e_loss.anchors_of(worlds.config)
    z = e_loss.read(anchors, worlds.states, gamma(loss, worlds.uniform), worlds.normals)
    z = held(z) if config.filter == 'hold' else z
    steps, h, noise = filter_of(config), rssi_function(anchors), constant_noise(anchors.sigma_db)
    belief = worlds.start
    means, covariances = [], []
    for k in range(z.shape[1]):
        predicted = steps.predict(belief, e_loss.PERIOD if k else 0.0)
        belief = steps.update(predicted, z[:, k], h, noise)
        means.append(belief.m[:, :2])
        covariances.append(belief.P[:, :2, :2])
    errors = position_errors(np.stack(means, axis=1), worlds.states)
    return Scores(errors, nees(errors, np.stack(covariances, axis=1)))
