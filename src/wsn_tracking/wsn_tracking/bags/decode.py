"""Many messages of one type at once: bytes to columns.

A CDR message has no index: where a field stands depends on the strings and sequences before it. Yet most
messages of a topic have the same shape, that is, equal length and equal bytes wherever a length or a text
stands. Messages of one shape are one NumPy record array: no call per message. What has no shape, or is too
rare to gain by one, goes through the typestore, with equal columns.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError

from wsn_tracking.bags.slices import Slices, gather, slices_of
from wsn_tracking.bags.types import typestore

CODES = {  # CDR base type -> little-endian NumPy type
    'bool': '<u1', 'byte': '<u1', 'char': '<u1',
    'uint8': '<u1', 'uint16': '<u2', 'uint32': '<u4', 'uint64': '<u8',
    'int8': '<i1', 'int16': '<i2', 'int32': '<i4', 'int64': '<i8', 'float32': '<f4', 'float64': '<f8',
}  # fmt: skip
LITTLE_ENDIAN = b'\x00\x01'
MIN_GROUP = 4  # below this many messages a shape costs more than it saves
MAX_SHAPES = 64  # per length: a bag in which every message is of another shape ends in the typestore


class Group(NamedTuple):
    """Decoded messages: `columns[dotted field name][k]` belongs to message `rows[k]`."""

    rows: NDArray[np.int64]
    columns: dict[str, Any]


class _Leaf(NamedTuple):
    path: str
    base: str
    kind: int  # Nodetype BASE, ARRAY or SEQUENCE
    fixed: int  # elements of an ARRAY


class _Shape(NamedTuple):
    dtype: np.dtype[np.void]
    marks: NDArray[np.int64]  # positions of the bytes that every message of this shape has in common
    constants: dict[str, Any]
    flags: tuple[str, ...]  # boolean fields


class _NoShape(Exception):
    """This message cannot be described by fixed positions."""


@cache
def _leaves(type_name: str, prefix: str = '') -> tuple[_Leaf, ...]:
    """The fields of a type in the order of the wire, nested types opened."""
    leaves: list[_Leaf] = []
    for field, (kind, detail) in typestore().fielddefs[type_name][1]:
        path = f'{prefix}{field}'
        if kind == Nodetype.NAME:
            leaves.extend(_leaves(cast(str, detail), f'{path}.'))
        elif kind == Nodetype.BASE:
            leaves.append(_Leaf(path, cast(str, detail[0]), int(kind), 1))
        else:
            (inner, base), count = cast(tuple[tuple[int, Any], int], detail)
            name = base[0] if inner == Nodetype.BASE else 'nested'
            leaves.append(_Leaf(path, name, int(kind), count))
    return tuple(leaves)


class _Cursor:
    """Walks one message and notes where things stand."""

    def __init__(self, cdr: bytes) -> None:
        self.cdr = cdr
        self.at = 4
        self.marks = [0, 1]

    def align(self, size: int) -> int:
        self.at = 4 + -(-(self.at - 4) // size) * size
        return self.at

    def length(self) -> int:
        start = self.align(4)
        if start + 4 > len(self.cdr):
            raise _NoShape
        self.marks.extend(range(start, start + 4))
        self.at = start + 4
        return int(struct.unpack_from('<I', self.cdr, start)[0])

    def text(self) -> str:
        size = self.length()
        start, self.at = self.at, self.at + size
        if size < 1 or self.at > len(self.cdr) or self.cdr[self.at - 1] != 0:
            raise _NoShape
        self.marks.extend(range(start, self.at))
        try:
            return self.cdr[start : self.at - 1].decode()
        except UnicodeDecodeError:
            raise _NoShape from None


def _shape(type_name: str, cdr: bytes) -> _Shape:
    if cdr[:2] != LITTLE_ENDIAN:
        raise _NoShape
    cursor = _Cursor(cdr)
    names, formats, offsets, flags = [], [], [], []
    constants: dict[str, Any] = {}
    for path, base, kind, fixed in _leaves(type_name):
        single = kind == Nodetype.BASE
        count = cursor.length() if kind == Nodetype.SEQUENCE else fixed
        if count > len(cdr):
            raise _NoShape
        if base == 'string':
            texts = tuple(cursor.text() for _ in range(count))
            constants[path] = texts[0] if single else texts
        elif base not in CODES:
            raise _NoShape
        else:
            code = np.dtype(CODES[base])
            start = cursor.align(code.itemsize) if count else cursor.at
            names.append(path)
            formats.append(code if single else (code, (count,)))
            offsets.append(start)
            cursor.at = start + count * code.itemsize
            if base == 'bool':
                flags.append(path)
    if cursor.at > len(cdr) or len(cdr) > cursor.at + 3:
        raise _NoShape
    layout = {'names': names, 'formats': formats, 'offsets': offsets, 'itemsize': len(cdr)}
    dtype = np.dtype(cast(Any, layout))
    return _Shape(dtype, np.array(cursor.marks), constants, tuple(flags))


def decode(type_name: str, messages: Slices | Sequence[bytes], fast: bool = True) -> tuple[list[Group], int]:
    """Decode messages of one type.

    Returns groups that together hold every message that could be decoded, once, and the number of those that
    could not. `fast=False` sends each through the typestore (the reference that tests compare with).
    """
    slices = messages if isinstance(messages, Slices) else slices_of(messages)
    groups: list[Group] = []
    slow: list[int] = []
    sizes = slices.stops - slices.starts
    for size in np.unique(sizes).tolist():
        rows = np.flatnonzero(sizes == size)
        if not fast or rows.size < MIN_GROUP or size < 4:
            slow.extend(rows.tolist())
        else:
            slow.extend(_by_shape(type_name, slices, rows, groups))
    bad = 0
    for row in slow:
        columns = _by_store(type_name, slices.one(row))
        if columns is None:
            bad += 1
        else:
            groups.append(Group(np.array([row]), columns))
    return groups, bad


def _by_shape(type_name: str, messages: Slices, rows: NDArray[np.int64], groups: list[Group]) -> Iterator[int]:
    """Append a group for each shape among messages of one length; yields the rows that are left over."""
    size = int(messages.stops[rows[0]] - messages.starts[rows[0]])
    data = gather(messages.data, messages.starts[rows], np.dtype(f'V{size}'))
    data = data.view(np.uint8).reshape(rows.size, size)
    left = rows
    for _ in range(MAX_SHAPES):
        if left.size < MIN_GROUP:
            break
        try:
            shape = _shape(type_name, data[0].tobytes())
        except _NoShape:
            yield int(left[0])
            left, data = left[1:], data[1:]
            continue
        same = np.all(data[:, shape.marks] == data[0, shape.marks], axis=1)
        chosen = data if same.all() else data[same]
        groups.append(Group(left[same], _columns(shape, chosen)))
        left, data = left[~same], data[~same]
    yield from left.tolist()


def _columns(shape: _Shape, data: NDArray[np.uint8]) -> dict[str, Any]:
    records = np.ascontiguousarray(data).reshape(-1).view(shape.dtype)
    columns: dict[str, Any] = {name: records[name] for name in shape.dtype.names or ()}
    columns.update({name: columns[name] != 0 for name in shape.flags})
    columns.update({name: [text] * records.size for name, text in shape.constants.items()})
    return columns


def message_of(type_name: str, cdr: bytes) -> Any | None:
    """One message as an object of rosbags, None where it cannot be decoded."""
    try:
        return typestore().deserialize_cdr(cdr, type_name)
    except (SerdeError, struct.error, ValueError, IndexError, OverflowError, AssertionError, MemoryError):
        return None


def _by_store(type_name: str, cdr: bytes) -> dict[str, Any] | None:
    """Columns of one message, None where it cannot be decoded."""
    message = message_of(type_name, cdr)
    if message is None:
        return None
    columns: dict[str, Any] = {}
    for path, base, kind, _ in _leaves(type_name):
        value: Any = message
        for part in path.split('.'):
            value = getattr(value, part)
        if base == 'string':
            columns[path] = [value if kind == Nodetype.BASE else tuple(value)]
        else:
            columns[path] = np.asarray(value)[np.newaxis]
    return columns
