"""The conversation with a sink that is up: it is pinged when it is silent, and told what the host wants said."""

from __future__ import annotations

import time
from collections import deque

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import (
    COORDINATOR_UP,
    AfDataRequestRsp,
    Command,
    UtilGetDeviceInfo,
    UtilGetDeviceInfoRsp,
)
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.queues import Outbox
from wsn_tracking.zstack.startup import ping, register

Questions = deque[tuple[Command, type[Command]]]


class Watchdog:
    """Pings a silent sink; after so many misses it is lost. One that forgot its network or us has restarted unheard."""

    def __init__(self, dialogue: Dialogue, radio: Radio) -> None:
        self._dialogue = dialogue
        self._radio = radio
        self._misses = 0
        self._pinged = 0.0

    @property
    def due(self) -> float:
        """When to ping, if nothing comes until then (time.monotonic)."""
        return max(self._dialogue.heard, self._pinged) + self._dialogue.timeout.idle

    def look(self) -> bool:
        """Ping if it is time, and say so; TrackingError if the sink is lost."""
        if time.monotonic() < self.due:
            return False
        dialogue = self._dialogue
        if dialogue.heard > self._pinged:
            self._misses = 0
        self._pinged = time.monotonic()
        dialogue.counters['pings'] += 1
        try:
            ping(dialogue)
        except TrackingError:
            if dialogue.heard > self._pinged:  # no answer, yet it speaks: it has restarted, or is busy
                return True
            self._misses += 1
            dialogue.counters['pings_missed'] += 1
            if self._misses >= dialogue.timeout.misses:
                raise TrackingError(f'the sink has not answered {self._misses} pings: is it still there?') from None
            return True
        if self._has_forgotten():
            dialogue.counters['found_down'] += 1
            dialogue.restarted = True
        return True

    def _has_forgotten(self) -> bool:
        """The line may have lost what a sink said when it restarted: without network or endpoint no message comes.

        An endpoint is forgotten where it is new at first and known when asked again: some sinks call it new for ever.
        """
        device = _try(self._dialogue, UtilGetDeviceInfo(), UtilGetDeviceInfoRsp)
        if not isinstance(device, UtilGetDeviceInfoRsp):
            return False
        try:
            return device.state != COORDINATOR_UP or (self._is_new() and not self._is_new())
        except TrackingError:
            return False

    def _is_new(self) -> bool:
        return register(self._dialogue, self._radio)


def speak(dialogue: Dialogue, outbox: Outbox, questions: Questions) -> bool:
    """Say the next thing that the host wants said, if one is due; a refusal is counted, not raised."""
    if questions:
        _try(dialogue, *questions.popleft())
        return True
    message = outbox.due(time.monotonic())
    if message is None:
        return False
    answer = _try(dialogue, message, AfDataRequestRsp)
    if not isinstance(answer, AfDataRequestRsp) or answer.status != 0:
        outbox.failed(message.trans_id)
    return True


def _try(dialogue: Dialogue, question: Command, answer: type[Command]) -> Command | None:
    try:
        return dialogue.ask(question, answer)
    except TrackingError:
        return None
