"""The shares that a node has heard: which are of use in its round, and who still counts as a neighbour."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from wsn_tracking.models.links import Links, is_cut, lost
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_share import Share

MAX_AHEAD = 2000  # shares of later epochs that are held of each neighbour

Key = tuple[int, int, int, int]  # stamp, target, epoch and round: one share of a neighbour


class Inbox:
    """Node `own`'s shares from its neighbours, whose x [m] is given; `counters` tells which were not used, and why.

    Whom to wait for is settled when an epoch opens: a neighbour that has been silent for `silent_epochs` does not
    count, one that speaks again does from the next epoch on.
    """

    def __init__(self, config: ConsensusConfig, own: int, x: float, neighbours: dict[int, float]) -> None:
        self.own, self.neighbours = own, tuple(sorted(neighbours))
        self.counters: Counter[str] = Counter()
        self._rounds, self._silent_epochs = config.rounds, config.silent_epochs
        self._links: Links = config.link.links()
        self._x, self._neighbours_x = x, [neighbours[i] for i in self.neighbours]
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self.active = self.neighbours
        self._silent = dict.fromkeys(self.neighbours, 0)
        self._epoch: Epoch | None = None
        self._round = 0
        self._shares: dict[tuple[int, int], Share] = {}  # by round and node
        self._answered: set[tuple[int, int]] = set()  # what has come, of use or not
        self._heard: set[int] = set()
        self._used: set[int] = set()
        self._latest: dict[int, tuple[int, int]] = {}  # stamp and round in which a neighbour has spoken last
        self._ahead: dict[int, dict[Key, Share]] = {i: {} for i in self.neighbours}

    def open(self, epoch: Epoch) -> None:
        """An epoch begins; whoever was not heard since the last one began has been silent for one more.

        A share that came too late for its round, or even for its epoch, still tells that its node is alive: a node that
        comes back is late in the eyes of those that do not wait for it.
        """
        if self._epoch is not None:
            self._silent = {i: 0 if i in self._heard else n + 1 for i, n in self._silent.items()}
        self.active = tuple(i for i in self.neighbours if self._silent[i] < self._silent_epochs)
        self._epoch, self._round = epoch, 0
        self._shares, self._answered, self._heard, self._used = {}, set(), set(), set()
        self._draw_faults(epoch.request_seq)
        for held in self._ahead.values():
            for key in [key for key in held if key[0] <= epoch.stamp_ns]:
                self.take(held.pop(key))

    def take(self, share: Share) -> None:
        """A well-formed share. Of an earlier epoch it is dropped, of a later one held until that opens."""
        if share.node_id not in self._silent:
            self.counters['not_a_neighbour'] += 1
        elif self._epoch is None or share.stamp_ns > self._epoch.stamp_ns:
            self._hold(share)
        elif self._epoch[:3] != (share.target_id, share.request_seq, share.stamp_ns):
            self.counters['foreign_epoch'] += 1
            if share.target_id == self._epoch.target_id and self._is_news(share):
                # it goes through an earlier epoch only now: late, but alive, unless its link was cut then
                self._heard |= {share.node_id} - self._cut_in(share.request_seq)
        else:
            self._take_now(share)

    def _hold(self, share: Share) -> None:
        """Keep a share of a later epoch; where a neighbour has too many, the one furthest in the future gives way."""
        held, key = self._ahead[share.node_id], (share.stamp_ns, share.target_id, share.request_seq, share.round)
        if key in held:
            self.counters['duplicate_share'] += 1
            return
        held[key] = share
        if len(held) > MAX_AHEAD:
            del held[max(held)]
            self.counters['share_overflow'] += 1

    def _take_now(self, share: Share) -> None:
        at = share.round, share.node_id
        if share.node_id in self._cut:
            self.counters['cut_share'] += 1
            self._answered.add(at)
            return
        self._heard.add(share.node_id)
        self._is_news(share)
        if share.round < self._round:
            self.counters['late_share'] += 1
        elif at in self._answered:
            self.counters['duplicate_share'] += 1
        elif share.node_id not in self.active:
            self.counters['joins_later'] += 1
        else:
            self._answered.add(at)
            if at in self._lost:
                self.counters['lost_share'] += 1
            else:
                self._shares[at] = share

    def _is_news(self, share: Share) -> bool:
        """Whether its node says what comes after all that it has said; remembers it."""
        at = share.stamp_ns, share.round
        if at <= self._latest.get(share.node_id, (-1, -1)):
            return False
        self._latest[share.node_id] = at
        return True

    @property
    def awaited(self) -> tuple[int, ...]:
        """Neighbours whose share of the round is still to come."""
        return tuple(i for i in self.active if (self._round, i) not in self._answered)

    def close_round(self) -> Sequence[Share]:
        """The round's shares, ascending by node; what comes later is late."""
        at, self._round = self._round, self._round + 1
        self.counters['missing_share'] += sum((at, i) not in self._answered for i in self.active)
        shares = [self._shares[at, i] for i in self.active if (at, i) in self._shares]
        self._used.update(share.node_id for share in shares)
        return shares

    @property
    def used(self) -> tuple[int, ...]:
        """Neighbours of whom a share was used in this epoch, ascending."""
        return tuple(sorted(self._used))

    def _cut_in(self, epoch: int) -> frozenset[int]:
        """The neighbours that nothing comes from in an epoch."""
        cut = is_cut(self._links, epoch, self._neighbours_x, self._x)
        return frozenset(i for i, down in zip(self.neighbours, cut.tolist(), strict=True) if down)

    def _draw_faults(self, epoch: int) -> None:
        """What the simulated links will do in an epoch."""
        self._cut = self._cut_in(epoch)
        self._lost: frozenset[tuple[int, int]] = frozenset()
        if self._links.loss > 0.0:
            senders, rounds = np.array(self.neighbours, dtype=np.int64), np.arange(self._rounds)
            fails = lost(self._links, self._links.seed, epoch, rounds[:, None], senders, self.own)
            self._lost = frozenset((t, self.neighbours[j]) for t, j in np.argwhere(fails).tolist())
