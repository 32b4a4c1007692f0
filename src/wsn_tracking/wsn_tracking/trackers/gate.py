"""Which local estimates are fused when: every live peer's of the same epoch, in the order of epochs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from wsn_tracking.trackers.estimate import Estimate

MISSES = 3  # epochs without word, and a peer is not waited for until it speaks again
MAX_HELD = 1000  # estimates held a peer


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
        self._pending: dict[int, tuple[Estimate, float]] = {}
        self._heard: dict[int, dict[int, Estimate]] = {peer: {} for peer in self.peers}
        self._misses: Counter[int] = Counter()
        self._done: int | None = None

    @property
    def waiting(self) -> bool:
        """Whether an own estimate is still to be fused."""
        return bool(self._pending)

    @property
    def absent(self) -> tuple[int, ...]:
        """The peers that are not waited for."""
        return tuple(peer for peer in self.peers if self._misses[peer] >= MISSES)

    def own_estimate(self, estimate: Estimate, now: float) -> None:
        """The estimator's own local estimate, published at steady time `now` [s]."""
        self._pending[estimate.request_seq] = (estimate, now)

    def peer_estimate(self, number: int, estimate: Estimate) -> None:
        """What a peer has published."""
        if number not in self._heard:
            self.counters['unknown_peer'] += 1
            return
        self._misses[number] = 0
        held = self._heard[number]
        if self._done is not None and estimate.request_seq <= self._done:
            self.counters['late_peer'] += 1
        elif estimate.request_seq in held:
            self.counters['duplicate_peer'] += 1
        elif len(held) >= MAX_HELD:
            self.counters['peer_overflow'] += 1
        else:
            held[estimate.request_seq] = estimate

    def ready(self, now: float) -> list[list[Estimate]]:
        """The epochs that can be fused by now, in order, each with the estimates that go in."""
        out = []
        while self._pending:
            seq = next(iter(self._pending))
            estimate, since = self._pending[seq]
            awaited = [p for p in self.peers if self._may_come(p, seq)]
            if awaited and now - since < self.timeout:
                break
            for peer in awaited:
                self._misses[peer] += 1
                self.counters['missing_peer'] += 1
            del self._pending[seq]
            self._done = seq
            out.append([estimate, *self._take(seq)])
        return out

    def deadline(self) -> float | None:
        """Steady time [s] at which `ready` would stop waiting; None while nothing waits."""
        return next(iter(self._pending.values()))[1] + self.timeout if self._pending else None

    def _may_come(self, peer: int, seq: int) -> bool:
        held = self._heard[peer]
        return self._misses[peer] < MISSES and seq not in held and not any(k > seq for k in held)

    def _take(self, seq: int) -> list[Estimate]:
        """What the peers said of an epoch; what they said of earlier ones has been missed."""
        taken = []
        for peer, held in self._heard.items():
            if seq in held:
                taken.append(held[seq])
            kept = {k: estimate for k, estimate in held.items() if k > seq}
            self.counters['late_peer'] += len(held) - len(kept) - (seq in held)
            self._heard[peer] = kept
        return taken
