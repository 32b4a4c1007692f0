"""What the firmware answers to which request: a table of handlers by header."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from wsn_tracking.zstack.firmware.chip import Chip
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.layout import Layout

SRSP = 0x4000  # what distinguishes the header of an answer from that of its request
Answer = Callable[..., Iterable[Frame]]


class Handler(NamedTuple):
    """How the data of a request lie, and who answers it."""

    layout: Layout
    answer: Answer


class Table:
    """Handlers of one subsystem."""

    def __init__(self) -> None:
        self.handlers: dict[int, Handler] = {}

    def on(self, header: int, layout: str = '') -> Callable[[Answer], Answer]:
        """Register the handler of a request, which takes the chip and the fields of the request."""

        def register(answer: Answer) -> Answer:
            self.handlers[header] = Handler(Layout(layout), answer)
            return answer

        return register


def srsp(request: int, *data: int | bytes) -> Frame:
    """The answer to a request: bytes, and small integers as one byte each."""
    return Frame(request + SRSP, b''.join(bytes((d,)) if isinstance(d, int) else d for d in data))


def take(handler: Handler, chip: Chip, data: bytes) -> list[Frame] | None:
    """What is answered; None where the data are too short. What is too much is not looked at, as in the firmware."""
    fields: list[Any] | None = handler.layout.unpack(data, exact=False)
    return None if fields is None else list(handler.answer(chip, *fields))
