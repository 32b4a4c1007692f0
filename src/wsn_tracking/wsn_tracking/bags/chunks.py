"""Chunks of an MCAP file: what is in them, also where they are damaged, and their messages at one glance."""

from __future__ import annotations

from collections.abc import Sequence

import lz4.frame  # type: ignore[import-untyped]
import numpy as np
import zstandard
from mcap.exceptions import McapError
from mcap.records import Chunk
from mcap.stream_reader import get_chunk_data_stream
from numpy.typing import NDArray

from wsn_tracking.bags.slices import gather

MAX_CHUNK = 2**30  # [bytes] a chunk that claims more is damaged
MESSAGE = 5  # opcode
HEAD = np.dtype(
    {
        'names': ['opcode', 'length', 'channel', 'log_ns'],
        'formats': ['u1', '<u8', '<u2', '<u8'],
        'offsets': [0, 1, 9, 15],  # the sequence number stands at 11, the time of publication at 23
        'itemsize': 31,
    }
)
SHORTEST = HEAD.itemsize - 9  # length that a message without content has


def content(chunk: Chunk) -> bytes | None:
    """Content of a chunk that is whole, None for another."""
    try:
        claimed = zstandard.frame_content_size(chunk.data) if chunk.compression == 'zstd' else 0
        if max(chunk.uncompressed_size, claimed) > MAX_CHUNK:
            return None  # would ask for that much memory
        stream, size = get_chunk_data_stream(chunk, validate_crc=True)
        return stream.read(size)
    except (ValueError, RuntimeError, MemoryError, McapError, zstandard.ZstdError):
        return None


def beginning(chunk: Chunk) -> bytes:
    """What a chunk that was cut off still gives; nothing where its checksum is merely wrong."""
    try:
        if chunk.compression == 'zstd':
            data = zstandard.ZstdDecompressor().decompressobj().decompress(chunk.data)
        elif chunk.compression == 'lz4':
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=MAX_CHUNK)
        else:
            data = chunk.data
    except (zstandard.ZstdError, RuntimeError, ValueError, MemoryError):
        return b''
    return data if len(data) < chunk.uncompressed_size else b''


def indexed(data: bytes, indexes: Sequence[bytes]) -> tuple[NDArray[np.void], NDArray[np.int64]] | None:
    """Heads (HEAD) of all messages and where they begin, by the chunk's index records; None: walk it.

    The index is a hint and nothing more: it is used only where the messages that it names follow each other
    from the first byte to the last, so that walking the records would meet the same ones.
    """
    if not indexes or any(len(index) < 6 or (len(index) - 6) % 16 for index in indexes):
        return None
    pairs = np.frombuffer(b''.join(index[6:] for index in indexes), dtype='<u8').reshape(-1, 2)
    starts = np.sort(pairs[:, 1])
    if starts.size == 0 or starts[0] != 0 or starts[-1] > len(data) - HEAD.itemsize:
        return None
    at = starts.astype(np.int64)
    heads = gather(data, at, HEAD)
    sizes = np.diff(starts, append=np.uint64(len(data)))
    whole = (heads['opcode'] == MESSAGE) & (heads['length'] >= SHORTEST) & (heads['length'] == sizes - np.uint64(9))
    return (heads, at) if whole.all() else None
