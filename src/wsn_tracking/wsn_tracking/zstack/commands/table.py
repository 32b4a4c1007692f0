"""Every command is a NamedTuple that is registered here with its header and layout; frames become commands and back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.frames import KINDS, SUBSYSTEMS, Frame, Kind
from wsn_tracking.zstack.layout import Layout, Shape

Command = tuple[Any, ...]  # any of the registered NamedTuples
C = TypeVar('C', bound=type[Command])


class Entry(NamedTuple):
    """What is known of one header."""

    name: str
    header: int
    make: type[Command]
    layout: Layout

    @property
    def exact(self) -> bool:
        """Data of unknown length are refused in what a host says; what sinks say has grown with their firmware."""
        return self.header >> 8 & 0xE0 == Kind.SREQ


BY_HEADER: dict[int, Entry] = {}
BY_CLASS: dict[type, Entry] = {}
SHAPES: dict[int, Shape] = {}
ANY = Shape(0, 250)


def command(
    header: int, name: str, layout: str = '', record: Callable[..., Any] | None = None, shape: Shape | None = None
) -> Callable[[C], C]:
    """Register a NamedTuple as the command of that header, under TI's name; `shape`: where the layout does not tell."""

    def register(make: C) -> C:
        compiled = Layout(layout, record) if record else Layout(layout)
        BY_HEADER[header] = BY_CLASS[make] = Entry(name, header, make, compiled)
        SHAPES[header] = shape or compiled.shape
        return make

    return register


def encode(value: Command) -> Frame:
    """The frame of a command; TrackingError where a value does not fit its field."""
    entry = BY_CLASS.get(type(value))
    if entry is None:
        raise TrackingError(f'{type(value).__name__} is no registered command: expected one of `zstack.commands`')
    return Frame(entry.header, entry.layout.pack(value))


def decode(frame: Frame) -> Command | Bad:
    """The command that a frame carries; Bad('unknown_command') or Bad('malformed')."""
    entry = BY_HEADER.get(frame.header)
    if entry is None:
        return Bad('unknown_command', f'{frame.header:04X}')
    fields = entry.layout.unpack(frame.data, exact=entry.exact)
    if fields is None:
        return Bad('malformed', f'{entry.name} of {len(frame.data)} data bytes')
    return entry.make(*fields)


def name_of(header: int) -> str:
    """TI's name of a header, or its digits."""
    entry = BY_HEADER.get(header)
    return entry.name if entry else f'{header:04X}'


def is_known(header: int) -> bool:
    """Whether there is a command of that header here."""
    return header in BY_HEADER


def shape_of(header: int) -> Shape | None:
    """What LEN a frame of that header can have; None where no stack uses such a header."""
    shape = SHAPES.get(header)
    if shape is not None:
        return shape
    cmd0 = header >> 8
    return ANY if cmd0 & 0xE0 in KINDS and cmd0 & 0x1F in SUBSYSTEMS else None
