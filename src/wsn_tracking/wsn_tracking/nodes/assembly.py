"""Epoch assembly as nodes use it: messages wait for the anchors, a timer looks at timeouts."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.node import Node

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.sensing.epochs import NO_LOSS, EpochAssembler
from wsn_tracking.sensing.values import Epoch, EpochEnd

MAX_EARLY = 10_000  # messages held until the anchors are known
TICK = 0.02  # [s] how often timeouts are looked at


class Assembly:
    """Holds messages until the anchors are known, then assembles epochs and hands them on in order."""

    def __init__(
        self,
        node: Node,
        config: AssemblyConfig,
        then: Callable[[Epoch], None],
        anew: Callable[[], None],
        *,
        timed: bool = True,
    ) -> None:
        self._config = config
        self._then = then
        self._anew = anew
        self._assembler: EpochAssembler | None = None
        self._early: list[tuple[str, Any, float]] = []
        self._runs = 0
        self._overflow = 0  # messages before the anchors that found no place
        self._logger = node.get_logger()
        self.last_seq = -1
        self._finals: dict[int, int] = {}  # each target's last epoch, once its feed has ended
        if timed:  # else whoever has many of them looks at all at once
            node.create_timer(TICK, self.advance)

    def start(self, anchors: Anchors, roster: Iterable[int]) -> None:
        """The anchors are known: from now on messages count, those that came before included."""
        self._assembler = EpochAssembler(
            roster,
            anchors.ids.tolist(),
            self._config.target_id,
            self._config.loss_timeout,
            self._config.lossless,
        )
        early, self._early = self._early, []
        for method, message, now in early:
            self.add(method, message, now)

    def add(self, method: str, message: Any, now: float) -> None:
        """A message: `request`, `measurement` or `listing`."""
        if self._assembler is None:
            if len(self._early) < MAX_EARLY:
                self._early.append((method, message, now))
            else:
                self._overflow += 1
            return
        getattr(self._assembler, method)(message, now)
        self.advance()

    def request(self, message: Any, now: float) -> None:
        """A Request."""
        self.add('request', message, now)

    def measurement(self, message: Any, now: float) -> None:
        """A measurement."""
        self.add('measurement', message, now)

    def listing(self, message: Any, now: float) -> None:
        """What was sent: an EpochEnd or a TriggerReport."""
        self.add('listing', message, now)

    def end(self, end: EpochEnd, now: float, *, lists: bool) -> None:
        """An EpochEnd; `lists`: of the measurements that are taken here."""
        if end.final:
            self._finals[end.target_id] = end.request_seq
        if lists:
            self.listing(end, now)

    @property
    def final_seq(self) -> int | None:
        """The last epoch of the target, once its feed has ended."""
        return self._finals.get(self.target_id)

    @property
    def target_id(self) -> int:
        """The target whose epochs these are; -1: nobody was heard yet."""
        return self._config.target_id if self._assembler is None else self._assembler.target_id

    def advance(self) -> None:
        """Hand on every epoch that can be closed by now."""
        if self._assembler is None:
            return
        while epochs := self._assembler.closed(time.monotonic()):  # those of one run at a time
            if self._assembler.runs != self._runs:
                self._runs = self._assembler.runs
                self._logger.warning('requests jumped back by more than 1 s: a new run, everything starts anew')
                self._anew()
            for epoch in epochs:
                self.last_seq = epoch.request_seq
                self._then(epoch)

    @property
    def counters(self) -> dict[str, int]:
        """What was used and what was not, the latter under `dropped.` and its reason."""
        counters = {} if self._assembler is None else self._assembler.run_counters
        told = {name if name in NO_LOSS else f'dropped.{name}': count for name, count in counters.items()}
        return {**told, 'dropped.overflow': told.get('dropped.overflow', 0) + self._overflow}

    @property
    def waits_for(self) -> str:
        """What the oldest open epoch still lacks, in words."""
        return 'anchors' if self._assembler is None else self._assembler.waits_for
