"""What a fault can do: it overrides the hook of the place where it strikes; the others leave things as they are."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from enum import Enum
from typing import NamedTuple

from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.motes import Message, Node


class Write(NamedTuple):
    """Bytes that go onto the line at once, and how long the line rests afterwards [s]."""

    data: bytes
    pause: float = 0.0


class Event(Enum):
    """What happens to the sink as a whole."""

    RESET = 'reset'
    UNPLUG = 'unplug'
    MUTE = 'mute'


class Happening(NamedTuple):
    """An event and how long it lasts [s]."""

    event: Event
    seconds: float


class Fault:
    """`value` is a share of what could be struck, or the epoch in which it strikes; `seconds` is how long it lasts."""

    stage = 0  # on the line, whole frames are struck first, then what lies between them, then how they are written

    def __init__(self, value: float, seconds: float, seed: int) -> None:
        self.value = value
        self.seconds = seconds
        self.random = random.Random(f'{seed} {type(self).__name__}')
        self.strikes = 0  # how often it has struck

    def hits(self) -> bool:
        """Whether it strikes this time, where `value` is a share."""
        hit = self.random.random() < self.value
        self.strikes += hit
        return hit

    # ---- the hooks

    def first_tick(self, tick: int) -> int:
        """Where the sink's clock starts."""
        return tick

    def nodes(self, nodes: Mapping[int, Node], epoch: int, now: float) -> list[Frame]:
        """Change the motes before an epoch; what the sink tells the host of it."""
        return []

    def air(self, messages: list[Message]) -> list[Message]:
        """What reaches the sink of an epoch's messages, in that order."""
        return messages

    def held(self) -> list[Message]:
        """What was held back of the messages, when there are no more to come."""
        return []

    def refuses(self, request: Frame) -> bool:
        """Whether the sink does not know this request."""
        return False

    def reply(self, request: Frame, replies: Sequence[Frame]) -> list[tuple[float, Frame]]:
        """What the sink says to a request, and after how long [s]."""
        return [(0.0, reply) for reply in replies]

    def line(self, write: Write) -> list[Write]:
        """What goes onto the line in the place of some bytes."""
        return [write]

    def flush(self) -> list[Write]:
        """What was held back, when the line has been quiet."""
        return []

    def at_plug(self) -> bytes:
        """What the host finds when it opens the port."""
        return b''

    def happens(self, epoch: int) -> Happening | None:
        """What happens to the sink as the epoch begins."""
        return None


def struck_replies(faults: Sequence[Fault], request: Frame, replies: Sequence[Frame]) -> list[tuple[float, Frame]]:
    """What becomes of the answers to a request, one fault after the other, and after how long [s] each is said."""
    later = [(0.0, reply) for reply in replies]
    for fault in faults:
        delay = max((seconds for seconds, _ in later), default=0.0)
        later = [(delay + more, reply) for more, reply in fault.reply(request, [reply for _, reply in later])]
    return later
