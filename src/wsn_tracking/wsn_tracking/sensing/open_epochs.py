"""Epochs that are still filling, in bounded memory."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from wsn_tracking.sensing.values import EpochEnd, Measurement, Request, TriggerReport

MAX_OPEN = 1000  # epochs held at once
MAX_SIZE = 200_000  # measurements and list entries held at once

Key = tuple[int, int]  # node_id, seq: one packet of an epoch
Listing = EpochEnd | TriggerReport


@dataclass
class OpenEpoch:
    """What has come for one epoch."""

    seq: int
    touched: float  # steady time of the last message that told something new [s]
    request: Request | None = None
    packets: dict[Key, Measurement] = field(default_factory=dict)
    lists: list[Listing] = field(default_factory=list)
    listed: set[Key] = field(default_factory=set)
    covered: set[int] = field(default_factory=set)

    @property
    def messages(self) -> int:
        """How many messages are held."""
        return len(self.packets) + len(self.lists) + (self.request is not None)

    @property
    def size(self) -> int:
        """How many measurements and list entries are held."""
        return len(self.packets) + len(self.lists) + len(self.listed)

    @property
    def stamp_ns(self) -> int:
        """The request's stamp; where that is lost, the latest of what came."""
        if self.request is not None:
            return self.request.stamp_ns
        return max(message.stamp_ns for message in (*self.packets.values(), *self.lists))

    @property
    def lost(self) -> list[Key]:
        """What was listed and has not come."""
        return sorted(self.listed - self.packets.keys())

    def sent(self) -> list[Measurement]:
        """The packets that count: what a node's list does not name came too late for whoever wrote the list."""
        return [p for key, p in self.packets.items() if key in self.listed or key[0] not in self.covered]

    def lacks(self, awaited: Iterable[int]) -> bool:
        """Whether anything is still to come; the lists of the nodes `awaited` are waited for."""
        return self.request is None or not (self.covered.issuperset(awaited) and self.listed <= self.packets.keys())

    def missing(self, awaited: Iterable[int]) -> str:
        """The same in words; empty where nothing is."""
        parts = []
        if self.request is None:
            parts.append('its request')
        if unlisted := sorted(set(awaited) - self.covered):
            parts.append(f'the list of nodes {unlisted}')
        if self.lost:
            parts.append(f'the measurements (node, seq) {self.lost}')
        return ' and '.join(parts)


class OpenEpochs:
    """Open epochs by number.

    Garbage may name any number and any packet. Where there are too many, what lies furthest in the future and
    has no request gives way; `gave_way` counts the messages. A request always finds room.
    """

    def __init__(self) -> None:
        self._by_seq: dict[int, OpenEpoch] = {}
        self._size = 0
        self.gave_way = 0

    def __len__(self) -> int:
        return len(self._by_seq)

    def get(self, seq: int) -> OpenEpoch | None:
        """The epoch of that number, where it is open."""
        return self._by_seq.get(seq)

    @property
    def seqs(self) -> list[int]:
        """The numbers of the open epochs, ascending."""
        return sorted(self._by_seq)

    @property
    def head(self) -> OpenEpoch | None:
        """The epoch that is to be closed next; None while no open epoch has its request, which alone orders them."""
        for epoch in self._by_seq.values():
            if epoch.request is not None:
                return self._by_seq[min(self._by_seq)]
        return None

    @property
    def messages(self) -> int:
        """How many messages are held."""
        return sum(epoch.messages for epoch in self._by_seq.values())

    def has_whole(self, awaited: Iterable[int], then: float) -> bool:
        """Whether any epoch lacks nothing, and has told nothing new since the steady time `then` [s]."""
        return any(epoch.touched <= then and not epoch.lacks(awaited) for epoch in self._by_seq.values())

    def ask(self, request: Request, now: float) -> bool:
        """Add a request; False where the epoch has one."""
        self._make_room(request.seq, is_request=True)
        epoch = self._place(request.seq, now)
        if epoch.request is not None:
            return False
        epoch.request, epoch.touched = request, now
        return True

    def add(self, packet: Measurement, now: float) -> str:
        """Add a packet; the reason where it is not taken: duplicate, overflow."""
        epoch, key = self.get(packet.request_seq), (packet.node_id, packet.seq)
        if epoch is not None and key in epoch.packets:
            return 'duplicate'
        if not self._make_room(packet.request_seq):
            return 'overflow'
        epoch = self._place(packet.request_seq, now)
        epoch.packets[key], epoch.touched = packet, now
        self._size += 1
        return ''

    def cover(self, listing: Listing, covered: Collection[int], sent: Collection[Key], now: float) -> str:
        """Add a list of what the nodes `covered` sent; the reason where it is not kept: lists (not new), overflow."""
        epoch = self.get(listing.request_seq)
        if epoch is not None and epoch.covered.issuperset(covered) and epoch.listed.issuperset(sent):
            return 'lists'
        if not self._make_room(listing.request_seq):
            return 'overflow'
        epoch = self._place(listing.request_seq, now)
        before = epoch.size
        epoch.lists.append(listing)
        epoch.covered.update(covered)
        epoch.listed.update(sent)
        epoch.touched = now
        self._size += epoch.size - before
        return ''

    def pop(self, seq: int) -> OpenEpoch:
        """Take an epoch out."""
        epoch = self._by_seq.pop(seq)
        self._size -= epoch.size
        return epoch

    def _place(self, seq: int, now: float) -> OpenEpoch:
        return self._by_seq.setdefault(seq, OpenEpoch(seq, now))

    def _make_room(self, seq: int, is_request: bool = False) -> bool:
        known = self.get(seq)
        asked = is_request or (known is not None and known.request is not None)
        while self._size >= MAX_SIZE or (known is None and len(self._by_seq) >= MAX_OPEN):
            furthest = max((s for s, e in self._by_seq.items() if e.request is None and s != seq), default=-1)
            if furthest < 0 or (furthest < seq and not asked):
                return is_request
            self.gave_way += self.pop(furthest).messages
        return True
