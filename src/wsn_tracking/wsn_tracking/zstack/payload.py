"""What nodes put into their messages: payload version 1 (zstack.md, section 6).

Header 12 bytes, n records of 8 bytes, CRC-16/CCITT-FALSE. What the wire calls invalid or unknown is None here.
"""

from __future__ import annotations

import binascii
import struct
from enum import IntEnum, IntFlag
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.records import FORMATS, Record, pack_record, unpack_record

VERSION = 1
MAX_RECORDS = 8  # decoded; at most 6 are recommended
HEADER = struct.Struct('<BBHHIBB')
OVERHEAD = HEADER.size + 2
BATTERY_MV = 20  # per unit


class PayloadType(IntEnum):
    """What a payload is; 1 to 4 go up to the host, 5 and 6 down to the nodes."""

    RSSI = 1
    HEARTBEAT = 2
    RANGE = 3
    WORN = 4
    FEEDBACK = 5
    COMMAND = 6


DOWN = (PayloadType.FEEDBACK, PayloadType.COMMAND)


class Flag(IntFlag):
    """Bits of `Payload.flags`."""

    EVENT_TRIGGERED = 1
    CLOCK_SYNCHRONISED = 2
    BATTERY_LOW = 4
    RETRY = 8


class Payload(NamedTuple):
    """One payload; `seq` and `t_ms` are None only in reports that came as text. Downwards node_id is 0, the host."""

    type: int
    node_id: int
    seq: int | None  # modulo 2^16
    t_ms: int | None  # node clock at sending [ms], modulo 2^32
    records: tuple[Record, ...] = ()
    flags: int = 0
    battery_mv: int | None = None


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF; of b'123456789' it is 0x29B1."""
    return binascii.crc_hqx(data, 0xFFFF)


def encode_payload(payload: Payload) -> bytes:
    """The bytes of a payload; TrackingError where a value does not fit."""
    if payload.type not in FORMATS:
        raise TrackingError(f'payload of type {payload.type}: expected 1 to 6')
    limit = 0 if payload.type == PayloadType.HEARTBEAT else MAX_RECORDS
    if len(payload.records) > limit:
        raise TrackingError(f'{len(payload.records)} records in a payload of type {payload.type}: at most {limit}')
    try:
        header = HEADER.pack(
            VERSION << 4 | payload.type,
            payload.flags,
            payload.node_id,
            payload.seq or 0,
            payload.t_ms or 0,
            len(payload.records),
            (payload.battery_mv or 0) // BATTERY_MV,
        )
        body = header + b''.join(pack_record(payload.type, record) for record in payload.records)
    except (struct.error, TypeError, ValueError, AttributeError) as error:
        raise TrackingError(f'{payload} cannot be encoded ({error}): expected values that fit their fields') from None
    return body + crc16(body).to_bytes(2, 'little')


def decode_payload(data: bytes) -> Payload | Bad:
    """The payload; Bad with reason payload_length, payload_crc, payload_version or payload_type."""
    if len(data) < OVERHEAD:
        return Bad('payload_length', f'{len(data)} bytes, at least {OVERHEAD} expected')
    kind, flags, node_id, seq, t_ms, n, battery = HEADER.unpack_from(data)
    version, kind = kind >> 4, kind & 0x0F
    if version == VERSION and len(data) != OVERHEAD + 8 * n:
        return Bad('payload_length', f'{len(data)} bytes, {OVERHEAD + 8 * n} expected for {n} records')
    if crc16(data[:-2]) != int.from_bytes(data[-2:], 'little'):
        return Bad('payload_crc', f'{data[-2:].hex()}, {crc16(data[:-2]).to_bytes(2, "little").hex()} expected')
    if version != VERSION:
        return Bad('payload_version', f'version {version}, {VERSION} expected')
    if kind not in FORMATS:
        return Bad('payload_type', f'type {kind}, 1 to 6 expected')
    if n > (0 if kind == PayloadType.HEARTBEAT else MAX_RECORDS):
        return Bad('payload_length', f'{n} records in a payload of type {kind}')
    records = tuple(unpack_record(kind, data, HEADER.size + 8 * i) for i in range(n))
    return Payload(kind, node_id, seq, t_ms, records, flags, battery * BATTERY_MV or None)
