"""Tables of numbers in a MATLAB file of level 5, as far as a recording needs them.

Written after `MAT-File Format` of The MathWorks: a header of 128 bytes, then elements of a tag (type, length) and
data, packed with zlib or not. SciPy's reader ends the whole process with a segmentation fault on some damaged
files; this one says what is wrong.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats

HEADER = 128  # [bytes]
ORDERS = {b'IM': '<', b'MI': '>'}  # the last two bytes of the header
MATRIX, COMPRESSED = 14, 15  # element types
NUMBERS = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 9: 'f8', 12: 'i8', 13: 'u8'}
NUMERIC = range(6, 16)  # array classes double, single, int8 ... uint64
LARGEST = 2**28  # [bytes] unpacked; a recording of a day has less


def read_tables(path: Path) -> dict[str, Floats]:
    """Every two-dimensional array of numbers by its name; others are left out. Raises where the file is none."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise TrackingError(f'{path} cannot be read: {error.strerror}') from error
    order = ORDERS.get(raw[HEADER - 2 : HEADER])
    if order is None:
        raise TrackingError(f'{path} is no MATLAB file of level 5: its header does not end in IM or MI')
    try:
        return dict(_tables(raw[HEADER:], order))
    except (struct.error, zlib.error, ValueError) as error:
        raise TrackingError(f'{path} is damaged or cut off: {error}') from error


def _tables(data: bytes, order: str) -> Iterator[tuple[str, Floats]]:
    for kind, content in _elements(data, order):
        if kind == COMPRESSED:
            packed = zlib.decompressobj()
            kind, content = next(_elements(packed.decompress(content, LARGEST), order), (0, b''))  # noqa: PLW2901
        if kind == MATRIX:
            yield from _matrix(content, order)


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Type and data of the elements one after the other."""
    at = 0
    while at < len(data):
        kind, length = struct.unpack_from(f'{order}II', data, at)
        if kind >> 16:  # a small one: its length beside its type, its data in the second half of the tag
            kind, length, start, end = kind & 0xFFFF, kind >> 16, at + 4, at + 8
        else:
            start = at + 8
            end = start + length if kind == COMPRESSED else start + (length + 7) // 8 * 8
        if start + length > len(data):
            raise ValueError(f'an element of {length} bytes where {len(data) - start} are left')
        yield kind, data[start : start + length]
        at = end


def _matrix(data: bytes, order: str) -> Iterator[tuple[str, Floats]]:
    """The array, where it is one of two dimensions."""
    parts = [part for _, part in zip(range(4), _elements(data, order), strict=False)]
    if len(parts) < 4:
        return
    (_, flags), (_, sizes), (_, name), (kind, numbers) = parts
    shape = struct.unpack(f'{order}{len(sizes) // 4}i', sizes)
    if struct.unpack_from(f'{order}I', flags)[0] & 0xFF not in NUMERIC or len(shape) != 2 or kind not in NUMBERS:
        return
    values = np.frombuffer(numbers, dtype=order + NUMBERS[kind]).astype(np.float64)
    if min(shape) < 0 or math.prod(shape) != values.size:
        raise ValueError(f'array of {shape[0]} x {shape[1]} with {values.size} numbers')
    yield name.decode('ascii', errors='replace'), values.reshape(shape, order='F')
