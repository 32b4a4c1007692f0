"""A room with nodes along its walls, places in it, and what is surveyed there."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.matern import matern
from wsn_tracking.sensing.survey import survey_of_places

NODES, SIDE = 6, 10.0


def world(rng, p1_spread=2.0, n_spread=0.2):
    """Nodes along the walls of a room, with radios of one make."""
    positions = np.column_stack([rng.uniform(0.0, SIDE, (NODES, 2)), np.full(NODES, 2.0)])
    positions[np.arange(NODES), np.arange(NODES) % 2] = np.where(np.arange(NODES) < NODES // 2, 0.0, SIDE)
    p1, n = rng.normal(-55.0, p1_spread, NODES), rng.normal(2.2, n_spread, NODES)
    return make_anchors(range(NODES), positions, p1_dbm=p1, n=n, sigma_db=4.0)


def places(rng, count):
    """Places (count, 3) anywhere in the room, at a height of 1 m."""
    return np.column_stack([rng.uniform(0.0, SIDE, (count, 2)), np.ones(count)])


def strengths(anchors, points):
    """Mean signal strengths (places, nodes) [dBm]."""
    d = np.linalg.norm(points[:, None] - anchors.positions, axis=-1)
    return anchors.p1_dbm - 10.0 * anchors.n * np.log10(d)


def surveyed(anchors, points, values, counts=1.0):
    """A survey of these values, of unknown scatter."""
    shape = values.shape
    return survey_of_places(anchors, points, values, np.full(shape, np.nan), np.full(shape, counts))


def field(rng, points, amplitude, length):
    """A field (places, nodes) [dB] of its own for each node."""
    R = matern(points, points[:, :2], length) + 1e-9 * np.eye(len(points))
    return amplitude * np.linalg.cholesky(R) @ rng.standard_normal((len(points), NODES))


def covered(quantity, truth):
    """Which of the true values lie in their intervals."""
    return (quantity.low <= truth) & (truth <= quantity.high)
