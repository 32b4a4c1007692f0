"""Which local estimates are fused when: every live peer's of the same epoch, in the order of epochs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from wsn_tracking.trackers.estimate import Estimate

MISSES = 3  # epochs without word, and a peer is not waited for until it speaks again
MAX_HELD = 1000  # estimates held a peer

Epoch = tuple[int, int]  # request_seq, stamp_ns: a target that is restarted uses its numbers again


class FusionGate:
    """Holds back the fusion of epoch k until every live peer's local estimate of k is in, or `timeout` [s] is over.

    A peer that has spoken of a later epoch will not speak of k any more (its messages come in order).
    """

    def __init__(self, own: int, peers: Iterable[int], timeout: float) -> None:
        self.own = own
        self.peers = tuple(sorted(set(peers) - {own}))
        self.timeout = timeout
        self.counters: Counter[str] = Counter()
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        self._pending: dict[Epoch, tuple[Estimate, float]] = {}
        self._heard: dict[int, dict[Epoch, Estimate]] = {peer: {} for peer in self.peers}
        self._misses: Counter[int] = Counter()
        self._done: Epoch | None = None

    @property
    def waiting(self) -> bool:
        """Whether an own estimate is still to be fused."""
        return bool(self._pending)

    @property
    def absent(self) -> tuple[int, ...]:
        """The peers that are not waited for."""
        return tuple(peer for peer in self.peers if self._misses[peer] >= MISSES)

    @property
    def held(self) -> int:
        """How many estimates of peers wait for an own one."""
        return sum(len(held) for held in self._heard.values())

    def own_estimate(self, estimate: Estimate, now: float) -> None:
        """The estimator's own local estimate, published at steady time `now` [s]."""
        self._pending[_epoch(estimate)] = (estimate, now)

    def peer_estimate(self, number: int, estimate: Estimate) -> None:
        """What a peer has published."""
        if number not in self._heard:
            self.counters['unknown_peer'] += 1
            return
        self._misses[number] = 0
        held, epoch = self._heard[number], _epoch(estimate)
        if self._done is not None and _follows(self._done, epoch):
            self.counters['late_peer'] += 1
        elif epoch in held:
            self.counters['duplicate_peer'] += 1
        elif len(held) >= MAX_HELD:
            self.counters['peer_overflow'] += 1
        else:
            held[epoch] = estimate

    def ready(self, now: float) -> list[list[Estimate]]:
        """The epochs that can be fused by now, in order, each with the estimates that go in."""
        out = []
        while self._pending:
            epoch = next(iter(self._pending))
            estimate, since = self._pending[epoch]
            lacking = [peer for peer in self.peers if epoch not in self._heard[peer] and self._misses[peer] < MISSES]
            awaited = [peer for peer in lacking if not any(_follows(k, epoch) for k in self._heard[peer])]
            if awaited and now - since < self.timeout:
                break
            self._misses.update(awaited)
            if lacking:
                self.counters['missing_peer'] += len(lacking)
            del self._pending[epoch]
            self._done = epoch
            out.append([estimate, *self._take(epoch)])
        return out

    def _take(self, epoch: Epoch) -> list[Estimate]:
        """What the peers said of an epoch; what they said of earlier ones has been missed."""
        taken = []
        for peer, held in self._heard.items():
            if epoch in held:
                taken.append(held[epoch])
            kept = {k: estimate for k, estimate in held.items() if not _follows(epoch, k)}
            if missed := len(held) - len(kept) - (epoch in held):
                self.counters['late_peer'] += missed
            self._heard[peer] = kept
        return taken


def _epoch(estimate: Estimate) -> Epoch:
    return estimate.request_seq, estimate.stamp_ns


def _follows(epoch: Epoch, other: Epoch) -> bool:
    """Whether an epoch is the other or a later one, by number and by time; where these differ, nobody knows."""
    return epoch[0] >= other[0] and epoch[1] >= other[1]
