"""A flood whose items are what was read, in ten bytes each, instead of the information that it holds.

Every node linearises whatever it hears about its own prior: a filter of its own over the readings of its hops. That
costs N contributions a node-epoch where forwarded information costs one; it is here to show that ten bytes are enough.
"""

from __future__ import annotations

import numpy as np

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.filters import srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.information import absent, contribute, packed, to_belief, to_information, unpacked
from wsn_tracking.models import arrival
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.arrival import NEGLIGIBLE
from wsn_tracking.models.graph import adjacency, reached
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.models.range_bearing import range_bearing_function
from wsn_tracking.studies.consensus_runs import Scores, Worlds
from wsn_tracking.trackers.consensus import Network
from wsn_tracking.trackers.consensus_config import ConsensusConfig, arrival_of, loss_model_of


def as_sent(z: Floats, mu: Floats) -> tuple[Floats, Floats]:
    """What is left of readings (..., 2) and weights (...) in ten bytes, two of them the id's.

    The range in four, the bearing and the weight in two each.
    """
    sent = np.stack([z[..., 0].astype(np.float32), z[..., 1].astype(np.float16)], axis=-1, dtype=np.float64)
    return sent, np.asarray(mu.astype(np.float16), dtype=np.float64)


def track_raw(config: ConsensusConfig, worlds: Worlds, ten_bytes: bool = True) -> Scores:
    """Every node of every run through all epochs of T = 1 s, with `config.rounds` hops and no loss."""
    known = reached(adjacency(worlds.positions, config.radius), config.rounds)
    nodes = Network(config, worlds.positions).start()
    belief, mu, loss = nodes.belief, nodes.mu, loss_model_of(config)
    F, chol_Q = constant_velocity(1.0), white_acceleration(config.spectral_density, 1.0)
    squares, normed, right = (np.empty(worlds.arrived.shape) for _ in range(3))
    for k in range(worlds.arrived.shape[1]):
        if k:
            belief, mu = srckf.predict(belief, F, chol_Q), arrival.predicted(arrival_of(config), mu)
        h = range_bearing_function(worlds.positions, belief.m)
        mu = contribute(belief, h, worlds.z[:, k], worlds.R, mu, loss).mu
        z, weight = as_sent(worlds.z[:, k], mu) if ten_bytes else (worlds.z[:, k], mu)
        weight = np.where(known & (weight >= NEGLIGIBLE)[:, None, :], weight[:, None, :], 0.0)
        total = _heard(belief, worlds, z, weight, config.observation.omega_weight(nodes.live[..., None]))
        belief, mu = to_belief(unpacked(packed(to_information(belief)) + total)), arrival.kept(mu)
        e = belief.m - worlds.states[:, k, None]
        squares[:, k], normed[:, k] = np.sum(e[..., :2] ** 2, axis=-1), nees(e, belief.P)
        right[:, k] = (mu > 0.5) == worlds.arrived[:, k]
    return Scores(squares, normed, right)


def _heard(belief: Belief, worlds: Worlds, z: Floats, weight: Floats, omega_weight: Floats) -> Floats:
    """Packed information (runs, N, 14) of all readings about each node's own prior; weight (runs, N, N)."""
    shape = weight.shape
    about = Belief(
        np.broadcast_to(belief.m[:, :, None], (*shape, 4)), np.broadcast_to(belief.chol_P[:, :, None], (*shape, 4, 4))
    )
    positions = np.broadcast_to(worlds.positions[:, None], (*shape, 3))
    h = range_bearing_function(positions, about.m)
    readings = np.broadcast_to(z[:, None], (*shape, 2))
    told = contribute(about, h, readings, worlds.R, np.full(shape, 0.5), absent, omega_weight)
    rows = packed(told.information)
    return np.asarray((weight[..., None, :] @ rows)[..., 0, :])
