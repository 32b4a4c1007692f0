"""Between the thread that reads the line and those of the host: what came, and what is to be sent; both bounded."""

from __future__ import annotations

import threading
from collections import deque
from typing import Any, NamedTuple

from wsn_tracking.zstack.commands import AfDataConfirm, AfDataRequest
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.settings import TimeoutConfig

UNCONFIRMED = 2  # messages to nodes of which the sink has not yet said how they went
ATTEMPTS = 2

COUNTERS = (
    'host_queue_dropped',
    'send_queue_dropped',
    'send_expired',
    'sent',
    'confirmed',
    'send_repeated',
    'send_failed',
    'confirms_missing',
    'confirms_unknown',
)


class Received(NamedTuple):
    """A report, an indication of the sink or a LinkEvent, and when it was read, host clock (monotonic) [ns]."""

    item: Any
    arrival_ns: int


class Inbox:
    """What the host has not yet taken; where there is no more room, the oldest gives way."""

    def __init__(self, capacity: int, counters: dict[str, int]) -> None:
        self._items: deque[Received] = deque()
        self._capacity = capacity
        self._counters = counters
        self._filled = threading.Condition()

    def put(self, received: Received) -> None:
        """Add at the end."""
        with self._filled:
            if len(self._items) >= self._capacity:
                self._items.popleft()
                self._counters['host_queue_dropped'] += 1
            self._items.append(received)
            self._filled.notify_all()

    def take(self, seconds: float = 0.0) -> list[Received]:
        """All there is, oldest first; where there is nothing, wait up to `seconds` for it."""
        with self._filled:
            if not self._items and seconds > 0.0:
                self._filled.wait(seconds)
            items = list(self._items)
            self._items.clear()
            return items


class Outgoing(NamedTuple):
    """A payload for a node, or for all (dst 0xFFFF)."""

    dst: int
    data: bytes
    born: float  # time.monotonic
    attempt: int = 1


class Flight(NamedTuple):
    """What was handed to the sink and is not confirmed."""

    outgoing: Outgoing
    deadline: float


class Outbox:
    """Messages to nodes: at most two on their way, each tried twice."""

    def __init__(self, radio: Radio, capacity: int, timeout: TimeoutConfig, counters: dict[str, int]) -> None:
        self._waiting: deque[Outgoing] = deque()
        self._flying: dict[int, Flight] = {}
        self._trans_id = 0
        self._radio = radio
        self._capacity = capacity
        self._timeout = timeout
        self._counters = counters
        self._lock = threading.Lock()

    def put(self, outgoing: Outgoing) -> None:
        """Have a message sent; where there is no more room, the oldest gives way."""
        with self._lock:
            if len(self._waiting) >= self._capacity:
                self._waiting.popleft()
                self._counters['send_queue_dropped'] += 1
            self._waiting.append(outgoing)

    @property
    def deadline(self) -> float:
        """When the next confirmation is overdue."""
        return min((flight.deadline for flight in self._flying.values()), default=float('inf'))

    def due(self, now: float) -> AfDataRequest | None:
        """The message to be sent now; overdue ones have failed."""
        for trans_id in [key for key, flight in self._flying.items() if flight.deadline <= now]:
            self._counters['confirms_missing'] += 1
            self.failed(trans_id)
        outgoing = self._next(now) if len(self._flying) < UNCONFIRMED else None
        if outgoing is None:
            return None
        self._trans_id = self._trans_id % 255 + 1
        self._flying[self._trans_id] = Flight(outgoing, now + self._timeout.confirm)
        self._counters['sent'] += 1
        radio = self._radio
        ends = (radio.endpoint, radio.endpoint, radio.cluster)
        return AfDataRequest(outgoing.dst, *ends, self._trans_id, 0, radio.default_radius, outgoing.data)

    def _next(self, now: float) -> Outgoing | None:
        """The oldest message that has not waited too long: a robot has no use for where it was."""
        with self._lock:
            while self._waiting:
                outgoing = self._waiting.popleft()
                if outgoing.attempt > 1 or now - outgoing.born <= self._timeout.send_age:
                    return outgoing
                self._counters['send_expired'] += 1
        return None

    def confirm(self, confirm: AfDataConfirm) -> None:
        """The sink says how a message went."""
        if confirm.trans_id not in self._flying:
            self._counters['confirms_unknown'] += 1
        elif confirm.status == 0:
            del self._flying[confirm.trans_id]
            self._counters['confirmed'] += 1
        else:
            self.failed(confirm.trans_id)

    def failed(self, trans_id: int) -> None:
        """A message was refused, or lost: try it once more."""
        flight = self._flying.pop(trans_id, None)
        if flight is None:
            return
        outgoing = flight.outgoing
        if outgoing.attempt >= ATTEMPTS:
            self._counters['send_failed'] += 1
            return
        self._counters['send_repeated'] += 1
        with self._lock:
            self._waiting.appendleft(outgoing._replace(attempt=outgoing.attempt + 1))

    def forget(self) -> None:
        """The sink has restarted: nothing on its way will be confirmed."""
        for trans_id in list(self._flying):
            self.failed(trans_id)
