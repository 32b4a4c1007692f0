"""Epoch assembly: closes epochs in order, each when the lists say that nothing of it is still to come.

Messages of one epoch come from several publishers and overtake each other; no clock says when it is
complete. A feeder's EpochEnd, or the sensing nodes' TriggerReports, list what was sent.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable
from dataclasses import dataclass, field

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.average import one_a_node
from wsn_tracking.sensing.values import Epoch, EpochEnd, Measurement, Request, TriggerReport

JUMP_NS = 1_000_000_000  # requests that fall back by more than this are a new run (a looped bag)
MAX_OPEN = 1000  # epochs held at once
MAX_LATE = 1000  # late messages held in case a new run's request is still to come
FORGET_AFTER = 3  # epochs without its report, and a node is no longer waited for

NO_LOSS = ('used', 'epochs', 'other_node')  # counters of what was not dropped

Key = tuple[int, int]  # node_id, seq

Listing = EpochEnd | TriggerReport


@dataclass
class _Open:
    """An epoch that is still filling."""

    request: Request | None = None
    listed: set[Key] = field(default_factory=set)
    covered: set[int] = field(default_factory=set)
    packets: dict[Key, Measurement] = field(default_factory=dict)
    touched: float = 0.0  # steady time of the last message [s]


class EpochAssembler:
    """Turns messages in any order into epochs in order.

    roster: the nodes whose measurements count and whose lists are waited for. loss_timeout [s] of silence
    closes an epoch without what is missing and counts it (`lost`), or raises where `lossless` promises that
    nothing can be missing. `counters` tells what was not used, by reason; nothing is dropped without.
    """

    def __init__(
        self,
        roster: Iterable[int],
        known: Iterable[int] | None = None,
        target_id: int = -1,
        loss_timeout: float = 2.0,
        lossless: bool = False,
    ) -> None:
        self.roster = frozenset(roster)
        self.known = self.roster if known is None else frozenset(known)
        self.wanted_target = target_id
        self.target_id = target_id
        self.loss_timeout = loss_timeout
        self.lossless = lossless
        self.counters: Counter[str] = Counter()
        self.runs = 0  # grows when requests jump back: whoever tracks starts anew
        self._late: deque[Measurement | Listing] = deque(maxlen=MAX_LATE)
        self._unreported: Counter[int] = Counter()
        self._forget()

    def _forget(self) -> None:
        self._open: dict[int, _Open] = {}
        self._closed_seq: int | None = None
        self._closed_stamp = 0
        self._started = False

    # ---- what comes in

    def request(self, request: Request, now: float) -> None:
        """A target asks to be located: the stream of requests is what orders epochs."""
        if not self._is_ours(request.target_id):
            return
        if self._started and request.stamp_ns < self._closed_stamp - JUMP_NS:
            self._begin_anew()
        elif self._closed_seq is not None and request.seq <= self._closed_seq:
            if request.stamp_ns <= self._closed_stamp:
                self.counters['late_request'] += 1
                return
            self._renumber()
        if not self._started:
            self._started = True
            for seq in [seq for seq in self._open if seq < request.seq]:
                self.counters['before_start'] += len(self._open.pop(seq).packets)
        epoch = self._epoch(request.seq, now)
        if epoch.request is not None:
            self.counters['duplicate_request'] += 1
        epoch.request = epoch.request or request
        self._revive(request.stamp_ns, now)

    def measurement(self, packet: Measurement, now: float) -> None:
        """One node's packet."""
        if not self._is_ours(packet.target_id):
            return
        if packet.node_id not in self.roster:
            self.counters['other_node' if packet.node_id in self.known else 'unknown_node'] += 1
            return
        if self._is_late(packet):
            self.counters['late'] += 1
            return
        epoch = self._epoch(packet.request_seq, now)
        key = (packet.node_id, packet.seq)
        if key in epoch.packets:
            self.counters['duplicate'] += 1
            return
        epoch.packets[key] = packet

    def listing(self, listing: Listing, now: float) -> None:
        """What was sent in an epoch: by everyone (EpochEnd), or by the nodes that a report names."""
        if not self._is_ours(listing.target_id) or self._is_late(listing):
            return
        epoch = self._epoch(listing.request_seq, now)
        if isinstance(listing, EpochEnd):
            sent = zip(listing.node_ids, listing.seqs, strict=True)
            covered: frozenset[int] = self.roster
        else:
            sent = zip(listing.sent_ids, listing.sent_seqs, strict=True)
            covered = self.roster & {*listing.sent_ids, *listing.silent_ids}
        epoch.listed.update(key for key in sent if key[0] in self.roster)
        epoch.covered |= covered
        for node in covered:
            self._unreported.pop(node, None)

    # ---- what goes out

    def closed(self, now: float) -> list[Epoch]:
        """The epochs that can be closed by now, in order."""
        out = []
        while self._started and self._open:
            requested = [seq for seq, epoch in self._open.items() if epoch.request is not None]
            head = min(self._open)
            if not requested:
                break  # the request of what is there is still under way
            epoch = self._open[head]
            missing = self._missing(epoch)
            overtaken = epoch.request is None and min(requested) > head
            if missing or overtaken:
                if now - epoch.touched < self.loss_timeout and len(self._open) <= MAX_OPEN:
                    break
                self._count_loss(head, epoch, missing)
            out.append(self._close(head))
        return out

    def deadline(self) -> float | None:
        """Steady time [s] at which `closed` would give up waiting; None while nothing is open."""
        if not (self._started and self._open):
            return None
        return self._open[min(self._open)].touched + self.loss_timeout

    @property
    def waits_for(self) -> str:
        """What the oldest open epoch still lacks, in words; empty when nothing is open."""
        if not self._open:
            return '' if self._started else 'the first request'
        head = min(self._open)
        return f'epoch {head}: ' + (self._missing(self._open[head]) or 'its request')

    # ---- within

    def _missing(self, epoch: _Open) -> str:
        awaited = {node for node in self.roster if self._unreported[node] < FORGET_AFTER}
        unlisted = sorted(awaited - epoch.covered)
        lost = sorted(epoch.listed - epoch.packets.keys())
        parts = []
        if unlisted:
            parts.append(f'the list of nodes {unlisted}')
        if lost:
            parts.append(f'the measurements (node, seq) {lost}')
        return ' and '.join(parts)

    def _count_loss(self, seq: int, epoch: _Open, missing: str) -> None:
        if self.lossless:
            raise TrackingError(
                f'epoch {seq} lacks {missing or "its request"} after {self.loss_timeout:g} s: a replay loses nothing, '
                'so its feed is broken or this machine is too slow for `loss_timeout`'
            )
        self.counters['lost'] += len(epoch.listed - epoch.packets.keys())
        self.counters['lost_request'] += epoch.request is None
        for node in self.roster - epoch.covered:
            self._unreported[node] += 1
        self.counters['unlisted_epoch'] += bool(self.roster - epoch.covered)

    def _close(self, seq: int) -> Epoch:
        epoch = self._open.pop(seq)
        stamps = [epoch.request.stamp_ns] if epoch.request else [p.stamp_ns for p in epoch.packets.values()]
        stamp = max(stamps, default=self._closed_stamp)
        self._closed_seq, self._closed_stamp = seq, max(stamp, self._closed_stamp)
        self.counters['used'] += len(epoch.packets)
        self.counters['epochs'] += 1
        return Epoch(self.target_id, seq, stamp, one_a_node(epoch.packets.values()))

    def _is_ours(self, target_id: int) -> bool:
        if self.target_id < 0:
            self.target_id = target_id
        if target_id != self.target_id:
            self.counters['other_target'] += 1
            return False
        return True

    def _is_late(self, message: Measurement | Listing) -> bool:
        if self._closed_seq is None or message.request_seq > self._closed_seq:
            return False
        self._late.append(message)
        return True

    def _epoch(self, seq: int, now: float) -> _Open:
        epoch = self._open.setdefault(seq, _Open())
        epoch.touched = now
        return epoch

    def _begin_anew(self) -> None:
        self.counters['discarded_by_reset'] += sum(len(epoch.packets) for epoch in self._open.values())
        self._forget()
        self._unreported.clear()
        self.runs += 1

    def _renumber(self) -> None:
        """The target counts anew (it was restarted), but time goes on: only the order starts again."""
        self.counters['renumbered'] += 1
        self.counters['discarded_by_reset'] += sum(len(epoch.packets) for epoch in self._open.values())
        self._open.clear()
        self._closed_seq = None
        self._started = False

    def _revive(self, stamp_ns: int, now: float) -> None:
        """What came before the request of a new run looked late: it counts after all."""
        held, self._late = self._late, deque(maxlen=MAX_LATE)
        for message in held:
            if message.stamp_ns > stamp_ns:
                self._late.append(message)
            elif message.stamp_ns < stamp_ns:
                continue
            elif isinstance(message, (EpochEnd, TriggerReport)):
                self.listing(message, now)
            else:
                self.counters['late'] -= 1
                self.measurement(message, now)
