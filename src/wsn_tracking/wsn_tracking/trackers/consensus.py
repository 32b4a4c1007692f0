"""System B over many runs at once: every node of every run in one array (seed 002, section 2.3).

The nodes of a live network do the same by messages (`trackers.consensus_node`). Both give the same numbers, losses
included, since these are drawn by the same keys.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.filters import srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.information import (
    Contribution,
    LossModel,
    contribute,
    is_definite,
    packed,
    to_belief,
    to_information,
    unpacked,
)
from wsn_tracking.fusion.consensus import SCHEMES, Scheme
from wsn_tracking.fusion.exchange import Agreement, Exchange
from wsn_tracking.models import arrival as chain
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.graph import adjacency, reached
from wsn_tracking.models.links import is_cut, lost
from wsn_tracking.models.range_bearing import range_bearing_function
from wsn_tracking.trackers.consensus_config import ConsensusConfig, arrival_of, loss_model_of, motion_of, prior_of


class Nodes(NamedTuple):
    """What every node knows between two epochs."""

    belief: Belief  # (..., N, 4)
    mu: Floats  # (..., N) probability that its observation arrived
    live: Floats  # (..., N) how many nodes its component had
    silent: NDArray[np.int64]  # (..., N, N) epochs for which node i has not heard node j


class Local(NamedTuple):
    """A node's epoch before it has heard anybody, as packed rows."""

    prior: Floats  # (..., 14) P^-1 x and P^-1
    own: Floats  # (..., 14) i and I
    mu: Floats  # (...)


def local_step(
    belief: Belief,
    mu: Floats,
    live: Floats,
    dt: float,
    z: Floats,
    R: Floats,
    positions: Floats,
    config: ConsensusConfig,
    loss: LossModel,
) -> Local:
    """Steps 1 to 4 of seed 002, section 2.3: predict by dt [s], and weigh what z (..., 2) says.

    belief (..., 4), mu (...), live nodes (...), positions (..., 3) [m], R (..., 2, 2). In the first epoch, dt = 0,
    nothing is predicted.
    """
    pi_1 = mu
    if dt > 0.0:
        belief = srckf.predict(belief, *motion_of(config, dt))
        pi_1 = chain.predicted(arrival_of(config), mu)
    h = range_bearing_function(positions, belief.m, config.target_height)
    own: Contribution = contribute(belief, h, z, R, pi_1, loss, config.observation.omega_weight(live))
    return Local(packed(to_information(belief)), packed(own.information), own.mu)


def posterior(scheme: Scheme, local: Local, value: Floats, plain: Floats, before: Floats, after: Floats) -> Belief:
    """Step 5: the belief after the rounds, from rows (..., 14) and live nodes before and after (...).

    An accelerated average may have lost its definiteness, and any where readings are exact beyond all digits. Then the
    last round is done plainly, and where that does not help a node keeps to what it knows alone, at worst to its prior.
    """
    row = scheme.finish(local.prior, value, before, after)
    try:
        return to_belief(unpacked(row))
    except np.linalg.LinAlgError:
        for other in (scheme.finish(local.prior, plain, before, after), local.prior + local.own, local.prior):
            row = np.where(is_definite(unpacked(row))[..., None], row, other)
        return to_belief(unpacked(row))


class Network:
    """All nodes of all runs; each call of `step` is an epoch.

    positions (..., N, 3) [m] with the runs first; ids (N,), by default 1 to N; link_seeds (...) of the runs' losses.
    """

    def __init__(
        self, config: ConsensusConfig, positions: Floats, ids: ArrayLike | None = None, link_seeds: ArrayLike = 0
    ) -> None:
        self.config = config.checked()
        self.positions = positions
        self.ids = np.arange(1, positions.shape[-2] + 1) if ids is None else np.asarray(ids)
        self.graph = adjacency(positions, config.radius)
        self.exchange = Exchange(SCHEMES[config.scheme], config.rounds, self.graph)
        self._links = config.link.links()
        self._seeds = (np.asarray(link_seeds) + self._links.seed)[..., None, None]
        self._loss_model = loss_model_of(config)

    def start(self, prior: Belief | None = None) -> Nodes:
        """Before the first epoch: the configured prior, or another one (..., N, 4)."""
        shape = self.graph.shape[:-1]
        m, chol_P = prior_of(self.config) if prior is None else prior
        belief = Belief(np.broadcast_to(m, (*shape, 4)), np.broadcast_to(chol_P, (*shape, 4, 4)))
        mu = np.full(shape, self.config.arrival.start)
        return Nodes(
            belief,
            mu,
            reached(self.graph, self.config.rounds).sum(axis=-1, dtype=np.float64),
            np.zeros(self.graph.shape, dtype=np.int64),
        )

    def step(
        self, nodes: Nodes, epoch: int, dt: float, z: Floats, R: Floats, alive: Mask | None = None
    ) -> tuple[Nodes, Agreement]:
        """One epoch: z (..., N, 2), NaN where nothing was read; R (..., 2, 2); alive (..., N), by default all."""
        local = local_step(nodes.belief, nodes.mu, nodes.live, dt, z, R, self.positions, self.config, self._loss_model)
        scheme = self.exchange.scheme
        active = self.graph & (nodes.silent < self.config.silent_epochs)
        up = self._up(epoch, alive)
        x = scheme.start(local.prior, local.own, nodes.live)
        if self._links.loss > 0.0:
            agreement = self.exchange.by_rounds(x, lambda t: active & up & ~self._lost(epoch, t), active)
        else:
            agreement = self.exchange.lossless(x, active & up, active)
        after = agreement.known.sum(axis=-1, dtype=np.float64)
        belief = posterior(scheme, local, agreement.value, agreement.plain, nodes.live, after)
        silent = np.where(up, 0, nodes.silent + 1)
        return Nodes(belief, chain.kept(local.mu), after, silent), agreement

    def _up(self, epoch: int, alive: Mask | None) -> Mask:
        """Links over which anything can come, (..., N, N)."""
        x = self.positions[..., 0]
        up = self.graph & ~is_cut(self._links, epoch, x[..., None, :], x[..., :, None])
        return up if alive is None else up & alive[..., None, :] & alive[..., :, None]

    def _lost(self, epoch: int, round_: int) -> Mask:
        return lost(self._links, self._seeds, epoch, round_, self.ids[None, :], self.ids[:, None])
