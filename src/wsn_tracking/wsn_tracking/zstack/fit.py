"""Whether the LEN of what begins like a frame fits its command, as far as can be seen.

Where the command leaves a choice, the truth may be one of its *lesser* LENs. What sinks say grows with their firmware,
and of a command that is not known nothing is: then every LEN below is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from wsn_tracking.zstack.commands import is_known, shape_of
from wsn_tracking.zstack.frames import MAX_DATA, OVERHEAD, Kind

GROWN = 16  # bytes by which a frame may be longer than its command is known to be
LONGEST = MAX_DATA + OVERHEAD
LENGTHS = range(MAX_DATA + 1)


class Fit(NamedTuple):
    """Why no frame begins somewhere, as far as LEN and command tell; '' where one may, and its lesser LENs.

    `is_exact`: it is just as long as its command is known to be.
    """

    fault: str = ''
    lesser: Sequence[int] = ()
    is_exact: bool = False


OPEN = Fit()  # that does not show yet


def end_of(held: bytes, at: int) -> int:
    """Where the frame that seems to begin at `at` ends; where LEN has not come, as far off as can be."""
    return at + (held[at + 1] + OVERHEAD if at + 1 < len(held) else LONGEST)


def fit_of(held: bytes, at: int) -> Fit:
    """Whether LEN fits the command of what seems to begin at `at`, as far as that can be seen."""
    if at + 1 >= len(held):
        return OPEN
    length = held[at + 1]
    if length > MAX_DATA:
        return Fit('bad_length')
    if at + 4 > len(held):
        return OPEN
    header = held[at + 2] << 8 | held[at + 3]
    shape = shape_of(header)
    if shape is None:
        return Fit('bad_header')
    if not is_known(header):
        return Fit('', LENGTHS[:length])
    if not 0 <= shape.at < length:
        return _between(shape.low, shape.high, length, header)
    if at + 4 + shape.at >= len(held):
        return OPEN
    known = shape.lengths(held[at + 4 + shape.at])
    if length in known:
        return Fit('', known[: known.index(length)], is_exact=True)
    least, most = (shape.low, shape.high) if shape.may_differ else (known[0], known[-1])
    return _between(least, most, length, header)


def _between(least: int, most: int, length: int, header: int) -> Fit:
    """Whether LEN is from `least` to `most`, or a little more where it may have grown."""
    is_question = header >> 8 & 0xE0 == Kind.SREQ  # nothing but this project's commands: they do not grow
    if not least <= length <= most + (0 if is_question else GROWN):
        return Fit('bad_length')
    return Fit('', LENGTHS[least:length], is_exact=length == least)
