"""One pass over an MCAP file: every message that is intact, whatever else is broken.

The index at the end of the file is not used: a recorder that was killed never wrote it, and all is read
anyway. What cannot be read is counted: `truncated` (the file ends within a record), `damaged` (a chunk or
record whose content contradicts itself), `unknown_channel` (a message of a channel that no record describes).
"""

from __future__ import annotations

import struct
from array import array
from collections import Counter
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import NamedTuple, TypeVar

import lz4.frame  # type: ignore[import-untyped]
import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError

MAGIC = b'\x89MCAP0\r\n'
MAX_CHUNK = 2**30  # [bytes] a chunk that claims more is damaged
_MESSAGE = struct.Struct('<QH4xQ8x')  # after the opcode: length, channel, (sequence,) log time (, publish time)
_RECORD = struct.Struct('<BQ')
R = TypeVar('R')


class RawTopic(NamedTuple):
    """A channel of the bag."""

    topic: str
    type_name: str
    encoding: str  # of the definition: ros2msg, ros2idl or empty
    definition: str
    qos: str  # YAML of the offered profiles, may be empty


class RawLog(NamedTuple):
    """All intact messages in the order of the log."""

    topics: tuple[RawTopic, ...]
    topic_of: NDArray[np.int64]  # (M,) row in `topics` of each message
    log_ns: NDArray[np.uint64]  # (M,)
    cdrs: list[bytes]
    metadata: dict[str, dict[str, str]]  # MCAP Metadata records by name
    dropped: dict[str, int]


class _Found:
    """What the pass has met so far."""

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.metadata: dict[str, dict[str, str]] = {}
        self.ids = array('H')  # channel of each message
        self.logs = array('Q')  # [ns]
        self.cdrs: list[bytes] = []
        self.dropped: Counter[str] = Counter()


def scan(path: Path) -> RawLog:
    """Read one file. Raises TrackingError where it cannot be read at all or is no MCAP file."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise TrackingError(f'{path} cannot be read: {error.strerror}') from error
    if not data:
        raise TrackingError(f'{path} is empty: an MCAP file is expected; record it again')
    if not data.startswith(MAGIC):
        raise TrackingError(f'{path} is no MCAP file: it begins with {data[:8]!r}, expected {MAGIC!r}')
    found = _Found()
    if not _walk(data, len(MAGIC), found, nested=False):
        found.dropped['truncated'] += 1
    return _log(found)


def _walk(data: bytes, at: int, found: _Found, nested: bool) -> bool:
    """Note every record of a file (or chunk, `nested`); False where the data ends too early."""
    end = len(data)
    add_id, add_log, add_cdr = found.ids.append, found.logs.append, found.cdrs.append
    unpack, message = _MESSAGE.unpack_from, int(Opcode.MESSAGE)
    while at < end:
        if data[at] == message and at + 31 <= end:
            length, channel, log_ns = unpack(data, at + 1)
            stop = at + 9 + length
            if length >= 22 and stop <= end:
                add_id(channel)
                add_log(log_ns)
                add_cdr(data[at + 31 : stop])
                at = stop
                continue
        if at + 9 > end:
            return False
        opcode, length = _RECORD.unpack_from(data, at)
        content = data[at + 9 : at + 9 + length]
        whole = len(content) == length
        if opcode == Opcode.CHUNK and not nested:
            _chunk(content, found)
        elif whole:
            _note(opcode, content, found)
        if not whole:
            return False
        at += 9 + length
        if opcode == Opcode.FOOTER:
            return nested or data[at:] == MAGIC
    return nested


def _note(opcode: int, content: bytes, found: _Found) -> None:
    if opcode == Opcode.SCHEMA:
        if schema := _record(Schema.read, content, found):
            found.schemas.setdefault(schema.id, schema)
    elif opcode == Opcode.CHANNEL:
        if channel := _record(Channel.read, content, found):
            found.channels.setdefault(channel.id, channel)
    elif opcode == Opcode.METADATA:
        if metadata := _record(Metadata.read, content, found):
            found.metadata[metadata.name] = metadata.metadata
    elif opcode == Opcode.MESSAGE:
        found.dropped['damaged'] += 1  # shorter than its own head


def _record(read: Callable[[ReadDataStream], R], content: bytes, found: _Found) -> R | None:
    try:
        return read(ReadDataStream(BytesIO(content)))
    except (McapError, struct.error, ValueError, OverflowError):
        found.dropped['damaged'] += 1
        return None


def _chunk(content: bytes, found: _Found) -> None:
    chunk = _record(Chunk.read, content, found)
    if chunk is None:
        return
    data = _content(chunk)
    if data is None:
        found.dropped['damaged'] += 1
        data = _beginning(chunk)
    _walk(data, 0, found, nested=True)


def _content(chunk: Chunk) -> bytes | None:
    """Content of a chunk that is whole, None for another."""
    try:
        claimed = zstandard.frame_content_size(chunk.data) if chunk.compression == 'zstd' else 0
        if max(chunk.uncompressed_size, claimed) > MAX_CHUNK:
            return None  # would ask for that much memory
        stream, size = get_chunk_data_stream(chunk, validate_crc=True)
        return stream.read(size)
    except (ValueError, RuntimeError, MemoryError, McapError, zstandard.ZstdError):
        return None


def _beginning(chunk: Chunk) -> bytes:
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


def _log(found: _Found) -> RawLog:
    topics: list[RawTopic] = []
    rows: dict[int, int] = {}
    for number, channel in found.channels.items():
        schema = found.schemas.get(channel.schema_id)
        rows[number] = len(topics)
        is_cdr = channel.message_encoding == 'cdr' and schema is not None
        topics.append(
            RawTopic(
                channel.topic,
                schema.name if schema and is_cdr else '',
                schema.encoding if schema else '',
                schema.data.decode('utf-8', 'replace') if schema else '',
                channel.metadata.get('offered_qos_profiles', ''),
            )
        )
    table = np.full(2**16, -1, dtype=np.int64)
    table[list(rows)] = list(rows.values())
    index = table[np.asarray(found.ids)]
    log_ns = np.asarray(found.logs, dtype=np.uint64)
    known = index >= 0
    cdrs = found.cdrs
    if not known.all():
        found.dropped['unknown_channel'] += int(np.sum(~known))
        cdrs = [cdr for cdr, keep in zip(cdrs, known.tolist(), strict=True) if keep]
        index, log_ns = index[known], log_ns[known]
    log = RawLog(tuple(topics), index, log_ns, cdrs, found.metadata, dict(found.dropped))
    return in_log_order(log)


def in_log_order(log: RawLog) -> RawLog:
    """The log sorted by time; messages of equal time stay in the order in which they were written."""
    if np.all(log.log_ns[1:] >= log.log_ns[:-1]):
        return log
    order = np.argsort(log.log_ns, kind='stable')
    cdrs = [log.cdrs[row] for row in order.tolist()]
    return log._replace(topic_of=log.topic_of[order], log_ns=log.log_ns[order], cdrs=cdrs)
