"""How the fields of a command lie in its data bytes, written as a short text.

Letters are those of `struct` (little endian: B u8, H u16, I u32, Q u64); `*H` is a count byte and that many H (`*B`
gives bytes), `*(QQHB)` likewise with records; what follows `?` may be absent; `$` is all that is left.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from wsn_tracking.errors import TrackingError

TOKENS = re.compile(r'[BHIQbhi]+(?![^(]*\))|\*(?:\([BHIQbhi]+\)|[BHIQ])|\?|\$')
MAX_LENGTH = 250


class Shape(NamedTuple):
    """What LEN can be, as far as it shows before the frame is complete.

    low <= LEN <= high. Where `at` >= 0 and LEN > at, data[at] counts items of `unit` bytes, and LEN is the end of the
    items plus one of `tails`; `may_differ`: so it is in what this project's nodes say, others may say something else.
    """

    low: int
    high: int
    at: int = -1
    unit: int = 0
    tails: tuple[int, ...] = ()
    may_differ: bool = False

    def lengths(self, count: int) -> list[int]:
        """What LEN can be with so many items, ascending."""
        return [self.at + 1 + self.unit * count + tail for tail in self.tails]


class Layout:
    """A compiled layout; `record` makes a value of one record of `*(...)`."""

    def __init__(self, text: str, record: Callable[..., Any] = lambda *fields: fields) -> None:
        self._steps = [_step(token) for token in TOKENS.findall(text)]
        self._record = record
        self.shape = _shape(self._steps)

    def unpack(self, data: bytes, *, exact: bool) -> list[Any] | None:
        """The fields (absent ones are left out); None where the data are too short or, if `exact`, too long."""
        fields: list[Any] = []
        at, end = 0, len(data)
        may_end = False
        for kind, part in self._steps:
            if kind == '?':
                may_end = True
            elif kind == '$':
                fields.append(data[at:])
                at = end
            elif kind == '*':
                if at >= end or (stop := at + 1 + data[at] * part.size) > end:
                    return None
                fields.append(self._items(part, data[at + 1 : stop]))
                at = stop
            elif at + part.size > end:
                if not may_end:
                    return None
                break
            else:
                fields += part.unpack_from(data, at)
                at += part.size
        return None if exact and at != end else fields

    def pack(self, fields: Sequence[Any]) -> bytes:
        """The data bytes; None stands for the first of the fields that are absent."""
        parts: list[bytes] = []
        rest = list(fields)
        try:
            for kind, part in self._steps:
                if kind == '?':
                    if rest[0] is None:
                        break
                elif kind == '$':
                    parts.append(rest.pop(0))
                elif kind == '*':
                    items = rest.pop(0)
                    packed = [part.pack(*(item if isinstance(item, tuple) else (item,))) for item in items]
                    parts.append(bytes((len(packed),)) + b''.join(packed))
                else:
                    count = len(part.format) - 1  # every letter is a field, '<' is none
                    parts.append(part.pack(*rest[:count]))
                    rest = rest[count:]
        except (struct.error, ValueError) as error:
            raise TrackingError(
                f'{tuple(fields)} cannot be encoded ({error}): expected values that fit their fields'
            ) from None
        return b''.join(parts)

    def _items(self, part: struct.Struct, data: bytes) -> Any:
        if part.format == '<B':
            return data
        if len(part.format) == len('<H'):
            return tuple(item for (item,) in part.iter_unpack(data))
        return tuple(self._record(*fields) for fields in part.iter_unpack(data))


Step = tuple[str, struct.Struct]


def _step(token: str) -> Step:
    kind = token[0] if token[0] in '*?$' else '.'
    return kind, struct.Struct('<' + token.strip('*?$()'))


def _shape(steps: Sequence[Step]) -> Shape:
    """The shape of a layout: LEN where each `?` stands, with all lists empty, and where the first list is counted."""
    ends, size, at, unit, lists, open_ended = [], 0, -1, 0, 0, False
    for kind, part in steps:
        if kind == '?':
            ends.append(size)
        elif kind == '$':
            open_ended = True
        elif kind == '*':
            at, unit = (size, part.size) if lists == 0 else (at, unit)
            lists += 1
            size += 1
        else:
            size += part.size
    ends.append(size)
    if lists == 1:
        return Shape(ends[0], MAX_LENGTH, at, unit, tuple(end - at - 1 for end in ends if end > at))
    return Shape(ends[0], MAX_LENGTH if lists or open_ended else size)
