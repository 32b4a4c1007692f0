"""Questions to the sink and their answers: one at a time, while everything else that comes is passed on.

An answer has the subsystem and the number of its question; what is no answer to the present question is late, and
discarded. A sink that restarts has forgotten the question.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import Command, RpcError, SysResetInd, ZdoStateChangeInd
from wsn_tracking.zstack.commands.table import BY_CLASS
from wsn_tracking.zstack.frames import Kind
from wsn_tracking.zstack.line import Line
from wsn_tracking.zstack.protocols import Item
from wsn_tracking.zstack.settings import TimeoutConfig

Answer = TypeVar('Answer', bound=Command)
Ear = Callable[[Item, int], None]  # what came, and when
Counters = dict[str, int]

EXCHANGE = 0x1FFF  # the part of a header that question and answer share

COUNTERS = ('stale_bytes', 'resets', 'requests', 'repeated_requests', 'no_answers', 'late_answers', 'rpc_errors')


class Dialogue:
    """A conversation with the sink on an open line; used by one thread."""

    def __init__(
        self,
        line: Line,
        timeout: TimeoutConfig,
        counters: Counters,
        ear: Ear = lambda item, arrival_ns: None,
        stopped: Callable[[], bool] = lambda: False,
    ) -> None:
        self.line = line
        self.timeout = timeout
        self.counters = counters
        self.restarted = False  # a SysResetInd came; whoever acts on it sets it back
        self.state: int | None = None  # device state, where the sink has told
        self.heard = time.monotonic()  # when the sink last said anything
        self.looked_ns = 0  # whatever had come by then was passed on, host clock (monotonic)
        self._ear = ear
        self._stopped = stopped
        self._awaited = -1
        self._answers: list[Command] = []

    def listen(self, until: float) -> None:
        """Pass on what comes; returns after each read, and at `until` (time.monotonic)."""
        if self._stopped():
            raise TrackingError('the link is being closed')
        items, arrival_ns = self.line.hear(until)
        for item in items:
            self.heard = time.monotonic()
            self._take(item, arrival_ns)
        self.looked_ns = arrival_ns

    def pause(self, seconds: float) -> None:
        """Pass on what comes for that long."""
        self.until(lambda: False, seconds)

    def until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Pass on what comes until the condition holds; False if it did not in time.

        A host that was held up until then finds what came in time lying ready: it looks once more.
        """
        end = time.monotonic() + seconds
        is_last = False
        while not condition():
            if is_last:
                return False
            is_last = time.monotonic() >= end
            self.listen(end)
        return True

    def ask(self, question: Command, answer: type[Answer], seconds: float = 0.0, tries: int = 1) -> Answer:
        """The answer; TrackingError if there is none in `seconds` (default: timeout.reply), or the sink refuses."""
        entry = BY_CLASS[type(question)]
        for attempt in range(tries):
            self.counters['repeated_requests'] += attempt > 0
            found = self._exchange(question, entry.header & EXCHANGE, seconds or self.timeout.reply)
            if found is not None:
                return self._understood(entry.name, found, answer)
            self.counters['no_answers'] += 1
        raise TrackingError(f'the sink does not answer {entry.name} (asked {tries} times)')

    def _exchange(self, question: Command, exchange: int, seconds: float) -> Command | None:
        self.counters['requests'] += 1
        before = self.counters['resets']
        self._awaited, self._answers = exchange, []
        try:
            self.line.say(question)
            self.until(lambda: bool(self._answers) or self.counters['resets'] > before, seconds)
        finally:
            self._awaited = -1
        if not self._answers and self.counters['resets'] > before:
            raise TrackingError(f'the sink restarted instead of answering {type(question).__name__}')
        return self._answers[0] if self._answers else None

    @staticmethod
    def _understood(name: str, found: Command, answer: type[Answer]) -> Answer:
        if isinstance(found, RpcError):
            raise TrackingError(f'the sink refuses {name}: {found.meaning}')
        if not isinstance(found, answer):
            raise TrackingError(f'the sink answers {name} with {found}: expected {answer.__name__}')
        return found

    def _take(self, item: Item, arrival_ns: int) -> None:
        if isinstance(item, SysResetInd):
            self.restarted, self.state = True, None
            self.counters['resets'] += 1
        elif isinstance(item, ZdoStateChangeInd):
            self.state = item.state
        elif isinstance(item, RpcError):
            self.counters['rpc_errors'] += 1
            self._settle(item.exchange, item)
        else:
            entry = BY_CLASS.get(type(item))
            if entry is not None and entry.header >> 8 & 0xE0 == Kind.SRSP:
                self._settle(entry.header & EXCHANGE, item)
        self._ear(item, arrival_ns)

    def _settle(self, exchange: int, answer: Command) -> None:
        if exchange == self._awaited and not self._answers:
            self._answers.append(answer)
        else:
            self.counters['late_answers'] += 1
