"""One pass over an MCAP file: every message that is intact, whatever else is broken.

The index at the end of the file is not used: a recorder that was killed never wrote it, and all is read
anyway. What cannot be read is counted: `truncated` (the file ends within a record), `damaged` (a chunk or
record whose content contradicts itself), `unknown_channel` (a message of a channel that no record describes).
"""

from __future__ import annotations

import struct
from array import array
from collections import Counter
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Metadata, Schema
from numpy.typing import NDArray

from wsn_tracking.bags.chunks import HEAD, SHORTEST, beginning, content, indexed
from wsn_tracking.bags.slices import Slices, gather, joined
from wsn_tracking.errors import TrackingError
from wsn_tracking.files import read_whole

MAGIC = b'\x89MCAP0\r\n'
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
    messages: Slices  # (M,)
    metadata: dict[str, dict[str, str]]  # MCAP Metadata records by name
    dropped: dict[str, int]


class _Part(NamedTuple):
    """Messages of one chunk, or between two chunks."""

    channels: NDArray[np.uint16]
    log_ns: NDArray[np.uint64]
    messages: Slices


class _Found:
    """What the pass has met so far."""

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.metadata: dict[str, dict[str, str]] = {}
        self.parts: list[_Part] = []
        self.dropped: Counter[str] = Counter()
        self.chunk: Chunk | None = None  # waits for its index records, which follow it
        self.indexes: list[bytes] = []

    def add(self, data: bytes, at: NDArray[np.int64], heads: NDArray[np.void] | None = None) -> None:
        """Note the messages whose records begin at these places."""
        if at.size:
            heads = gather(data, at, HEAD) if heads is None else heads
            stops = at + 9 + heads['length'].astype(np.int64)
            slices = Slices(data, at + HEAD.itemsize, stops)
            self.parts.append(_Part(heads['channel'], heads['log_ns'], slices))


def scan(path: Path) -> RawLog:
    """Read one file. Raises TrackingError where it cannot be read at all or is no MCAP file."""
    try:
        data = read_whole(path)
    except OSError as error:
        raise TrackingError(f'{path} cannot be read: {error.strerror}') from error
    if not data:
        raise TrackingError(f'{path} is empty: an MCAP file is expected; record it again')
    if not data.startswith(MAGIC):
        raise TrackingError(
            f'{path} is no MCAP file: it begins with {data[:8]!r}, expected {MAGIC!r}; other storages are converted by '
            '`ros2 bag convert`'
        )
    found = _Found()
    if not _file(data, found):
        found.dropped['truncated'] += 1
    return _log(found)


def _records(data: bytes, at: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, begin and end of each record; the last one may end beyond the data: it is cut off."""
    end = len(data)
    while at + _RECORD.size <= end:
        opcode, length = _RECORD.unpack_from(data, at)
        stop = at + _RECORD.size + length
        yield opcode, at, stop
        at = stop


def _file(data: bytes, found: _Found) -> bool:
    """Note every record of a file; False where it ends too early."""
    loose = array('q')  # messages outside of chunks
    complete = False
    for opcode, at, stop in _records(data, len(MAGIC)):
        record = data[at + _RECORD.size : stop]
        if opcode == Opcode.MESSAGE_INDEX:
            found.indexes.append(record)
            continue
        _settle(found)
        if opcode == Opcode.CHUNK:
            found.add(data, _places(loose))
            loose = array('q')
            found.chunk = _parsed(Chunk.read, record, found)
        elif stop <= len(data):
            _note(opcode, at, record, found, loose)
        if opcode == Opcode.FOOTER:
            complete = data[stop:] == MAGIC
            break
    _settle(found)
    found.add(data, _places(loose))
    return complete


def _settle(found: _Found) -> None:
    """Take the messages out of the chunk that waits."""
    chunk, indexes = found.chunk, found.indexes
    found.chunk, found.indexes = None, []
    if chunk is None:
        return
    data = content(chunk)
    if data is None:
        found.dropped['damaged'] += 1
        data = beginning(chunk)
    if hint := indexed(data, indexes):
        heads, at = hint
        found.add(data, at, heads)
        return
    places = array('q')
    for opcode, start, stop in _records(data, 0):
        if stop <= len(data):
            _note(opcode, start, data[start + _RECORD.size : stop], found, places)
    found.add(data, _places(places))


def _places(at: array[int]) -> NDArray[np.int64]:
    return np.array(at, dtype=np.int64)


def _note(opcode: int, at: int, record: bytes, found: _Found, messages: array[int]) -> None:
    """Note one whole record that begins at `at`."""
    if opcode == Opcode.MESSAGE:
        if len(record) >= SHORTEST:
            messages.append(at)
        else:
            found.dropped['damaged'] += 1
    elif opcode == Opcode.SCHEMA:
        if schema := _parsed(Schema.read, record, found):
            found.schemas.setdefault(schema.id, schema)
    elif opcode == Opcode.CHANNEL:
        if channel := _parsed(Channel.read, record, found):
            found.channels.setdefault(channel.id, channel)
    elif opcode == Opcode.METADATA and (metadata := _parsed(Metadata.read, record, found)):
        found.metadata[metadata.name] = metadata.metadata


def _parsed(read: Callable[[ReadDataStream], R], record: bytes, found: _Found) -> R | None:
    try:
        return read(ReadDataStream(BytesIO(record)))
    except (McapError, struct.error, ValueError, OverflowError):
        found.dropped['damaged'] += 1
        return None


def _log(found: _Found) -> RawLog:
    topics: list[RawTopic] = []
    rows = np.full(2**16, -1, dtype=np.int64)  # of each channel in `topics`
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
    parts = found.parts
    topic_of = rows[np.concatenate([np.zeros(0, np.uint16), *(part.channels for part in parts)])]
    log_ns = np.concatenate([np.zeros(0, np.uint64), *(part.log_ns for part in parts)])
    messages = joined([part.messages for part in parts])
    known = topic_of >= 0
    if not known.all():
        found.dropped['unknown_channel'] += int(np.sum(~known))
        topic_of, log_ns, messages = topic_of[known], log_ns[known], messages.select(known)
    log = RawLog(tuple(topics), topic_of, log_ns, messages, found.metadata, dict(found.dropped))
    return in_log_order(log)


def in_log_order(log: RawLog) -> RawLog:
    """The log sorted by time; messages of equal time stay in the order in which they were written."""
    if np.all(log.log_ns[1:] >= log.log_ns[:-1]):
        return log
    order = np.argsort(log.log_ns, kind='stable')
    return log._replace(topic_of=log.topic_of[order], log_ns=log.log_ns[order], messages=log.messages.select(order))
