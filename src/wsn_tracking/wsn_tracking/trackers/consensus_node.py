"""One node of system B as it lives in a network: it hears its neighbours by shares alone, whoever carries them.

An epoch is `begin`, as many `advance` as there are rounds, and `finish`; `receive` takes shares at any time and in any
order. There is no clock in here: whoever carries the shares advances a node when nothing is `awaited` any more, or when
a round has lasted too long.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.information import to_belief, unpacked
from wsn_tracking.fusion.consensus import SCHEMES
from wsn_tracking.fusion.exchange import check_rounds
from wsn_tracking.fusion.weights import chebyshev_factors, contraction, metropolis
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.arrival import NEGLIGIBLE, kept
from wsn_tracking.models.graph import adjacency, degrees, reached
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.consensus import Local, local_step, posterior
from wsn_tracking.trackers.consensus_config import ConsensusConfig, loss_model_of, noise_of, prior_of
from wsn_tracking.trackers.consensus_door import Door
from wsn_tracking.trackers.consensus_inbox import Inbox
from wsn_tracking.trackers.consensus_report import Outcome
from wsn_tracking.trackers.consensus_rounds import Averaging, Flooding, Rounds
from wsn_tracking.trackers.consensus_share import Share, ids_of, to_bytes
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.trackers.observation import observation_of


class _Now(NamedTuple):
    """The epoch that a node is in."""

    epoch: Epoch
    local: Local
    rounds: Rounds


class ConsensusNode:
    """Node `node_id` of system B; its neighbours are the anchors within the radius, or those that are named."""

    def __init__(self, config: ConsensusConfig, anchors: Anchors, node_id: int, neighbours: Sequence[int] = ()) -> None:
        self.config = config.checked()
        self.node_id = node_id
        self.anchor = anchors.select([node_id])
        graph, row = adjacency(anchors.positions, config.radius), int(anchors.rows(node_id))
        if neighbours:
            if node_id in neighbours:
                raise TrackingError(f'`neighbours` of node {node_id} name itself, for which it would wait: name others')
            graph[row] = graph[:, row] = np.isin(anchors.ids, anchors.select(neighbours).ids)
        x = dict(zip(anchors.ids[graph[row]].tolist(), anchors.positions[graph[row], 0].tolist(), strict=True))
        self.inbox = Inbox(config, node_id, float(anchors.positions[row, 0]), x)
        self.door = Door(config, anchors.ids.tolist())
        self._reach = float(reached(graph, config.rounds)[row].sum())
        self._scheme = SCHEMES[config.scheme]
        self._omegas: list[float] = []
        if self._scheme.accelerated:
            if neighbours:
                raise TrackingError('chebyshev needs the whole graph: take neighbours by `radius`, or another `scheme`')
            rho = float(contraction(metropolis(graph, degrees(graph))))
            check_rounds(rho, config.rounds)
            self._omegas = chebyshev_factors(rho, config.rounds)
        self._loss_model, self._R = loss_model_of(config), noise_of(config)
        self.reset()

    @property
    def neighbours(self) -> tuple[int, ...]:
        """Whose shares the node takes, ascending."""
        return self.inbox.neighbours

    @property
    def counters(self) -> Counter[str]:
        """The shares that were not used, by reason."""
        return self.inbox.counters

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self.inbox.reset()
        self._belief = prior_of(self.config)
        self._mu = np.array(self.config.arrival.start)
        self._live = self._reach
        self._stamp_ns: int | None = None
        self._now: _Now | None = None
        self._round = 0
        self._bits = 0
        self.arrival_probability = self.config.arrival.start
        self.disagreement = float('nan')
        self._known: tuple[int, ...] = (self.node_id,)

    @property
    def outcome(self) -> Outcome:
        """How the node came out of the epoch that it has finished last."""
        return Outcome(self.node_id, self.arrival_probability, self.disagreement, self._known, self.inbox.used)

    def begin(self, epoch: Epoch) -> Share | None:
        """Predict to the epoch and weigh what was read; the first round's share, None where there are no rounds."""
        if self._now is not None:
            raise TrackingError(
                f'node {self.node_id} begins epoch {epoch.request_seq} within epoch {self._now.epoch.request_seq}: '
                '`finish` that first'
            )
        dt = 0.0 if self._stamp_ns is None else max(epoch.stamp_ns - self._stamp_ns, 0) * 1e-9
        z, R = observation_of(epoch, self.anchor, self._R)
        live, position = np.array(self._live), self.anchor.positions[0]
        local = local_step(self._belief, self._mu, live, dt, z, R, position, self.config, self._loss_model)
        self.inbox.open(epoch)
        self._now = _Now(epoch, local, self._start(local))
        self._stamp_ns, self._round, self._bits = epoch.stamp_ns, 0, 1 << self.node_id
        return self._share(self._now)

    def receive(self, share: Share) -> None:
        """What somebody has said, at any time; what cannot be true is refused and counted."""
        try:
            self.door.check(share)
        except TrackingError:
            self.counters['malformed_share'] += 1
        else:
            self.take(share)

    def take(self, share: Share) -> None:
        """The same of a share that has passed the `door`, of this node or of another one alike."""
        self.inbox.take(share)

    @property
    def awaited(self) -> tuple[int, ...]:
        """Neighbours whose share of the round is still to come; none outside an epoch."""
        return self.inbox.awaited if self._now is not None and self._round < self.config.rounds else ()

    def advance(self) -> Share | None:
        """Close the round with what has come; the share of the next one, None after the last."""
        now = self._inside()
        shares = self.inbox.close_round()
        degree = len(self.inbox.active)
        now.rounds.close(shares, degree, missed=len(shares) < degree)
        for share in shares:
            self._bits |= int.from_bytes(share.live, 'little')
        self._round += 1
        return self._share(now)

    def finish(self) -> Estimate:
        """The estimate after the rounds that were held."""
        epoch, local, rounds = self._inside()
        live = ids_of(self._bits)
        before, after = np.array(self._live), np.array(float(len(live)))
        self._belief = posterior(self._scheme, local, rounds.value, rounds.plain, before, after)
        self.disagreement = self._moved(self._scheme.finish(local.prior, rounds.before, before, after))
        self.arrival_probability = float(local.mu)
        self._mu, self._live = kept(local.mu), float(len(live))
        self._now, self._known = None, live
        return Estimate(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            f'consensus_{self.node_id}',
            self._belief.m,
            self._belief.P,
            rounds.ids if isinstance(rounds, Flooding) else live,
            (self.node_id,) if self.arrival_probability >= NEGLIGIBLE else (),
            kind=Kind.CONSENSUS,
        )

    def _inside(self) -> _Now:
        if self._now is None:
            raise TrackingError(f'node {self.node_id} is in no epoch: `begin` one first')
        return self._now

    def _start(self, local: Local) -> Rounds:
        row = self._scheme.start(local.prior, local.own, np.array(self._live))
        if self._scheme.flooded:
            return Flooding(self._scheme.name, row, self.node_id)
        changed = self.inbox.active != self.inbox.neighbours
        return Averaging(self._scheme.name, row, self._omegas, fallen_back=changed)

    def _share(self, now: _Now) -> Share | None:
        if self._round >= self.config.rounds:
            return None
        epoch = now.epoch
        return Share(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            self._round,
            self.node_id,
            degree=len(self.inbox.active),
            live=to_bytes(self._bits),
            **now.rounds.payload()._asdict(),
        )

    def _moved(self, row: Floats) -> float:
        """How far the last round has moved the position [m]: what the neighbours still disagree about."""
        try:
            earlier = to_belief(unpacked(row))
        except np.linalg.LinAlgError:
            return float('nan')
        return float(np.hypot(*(self._belief.m - earlier.m)[:2]))
