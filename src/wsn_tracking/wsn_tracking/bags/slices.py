"""Many messages in one piece of memory, taken out without a Python object for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Slices(NamedTuple):
    """Message k is data[starts[k]:stops[k]]."""

    data: bytes
    starts: NDArray[np.int64]  # (M,)
    stops: NDArray[np.int64]  # (M,)

    def one(self, k: int) -> bytes:
        """Bytes of one message."""
        return self.data[self.starts[k] : self.stops[k]]

    def all(self) -> list[bytes]:
        """Bytes of every message."""
        return [self.data[a:b] for a, b in zip(self.starts.tolist(), self.stops.tolist(), strict=True)]

    def select(self, rows: NDArray[np.int64] | NDArray[np.bool_]) -> Slices:
        """These messages alone, in this order."""
        return Slices(self.data, self.starts[rows], self.stops[rows])


def slices_of(messages: Sequence[bytes]) -> Slices:
    """Messages that are objects of their own."""
    ends = np.cumsum([0, *map(len, messages)], dtype=np.int64)
    return Slices(b''.join(messages), ends[:-1], ends[1:])


def joined(parts: Sequence[Slices]) -> Slices:
    """The messages of all parts, one after another."""
    bases = np.cumsum([0, *(len(part.data) for part in parts)], dtype=np.int64)
    return Slices(
        b''.join(part.data for part in parts),
        np.concatenate([np.zeros(0, np.int64), *(p.starts + base for p, base in zip(parts, bases, strict=False))]),
        np.concatenate([np.zeros(0, np.int64), *(p.stops + base for p, base in zip(parts, bases, strict=False))]),
    )


def gather(data: bytes, starts: NDArray[np.int64], dtype: np.dtype[Any]) -> NDArray[Any]:
    """A record of `dtype` at each start (M,), alignment or not; every one must lie within the data.

    An array of overlapping records, one a byte, costs nothing; picking from it copies whole records.
    """
    if starts.size == 0 or dtype.itemsize == 0:
        return np.zeros(starts.size, dtype)
    overlapping: NDArray[Any] = np.ndarray((len(data) - dtype.itemsize + 1,), dtype, data, strides=(1,))
    picked: NDArray[Any] = overlapping[starts]
    return picked
