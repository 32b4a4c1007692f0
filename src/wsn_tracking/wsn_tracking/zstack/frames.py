"""The MT frame of TI's Z-Stack: FE LEN CMD0 CMD1 DATA FCS (zstack.md, section 2; TI SWRA198)."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from wsn_tracking.errors import TrackingError

SOF = 0xFE
MAX_DATA = 250
OVERHEAD = 5  # SOF, LEN, CMD0, CMD1, FCS


class Kind(IntEnum):
    """Who speaks, and whether an answer follows: bits 7-5 of CMD0."""

    POLL = 0x00
    SREQ = 0x20  # host asks
    AREQ = 0x40  # either side, no answer
    SRSP = 0x60  # sink answers


class Subsystem(IntEnum):
    """Which part of the stack is meant: bits 4-0 of CMD0."""

    RPC = 0
    SYS = 1
    MAC = 2
    NWK = 3
    AF = 4
    ZDO = 5
    SAPI = 6
    UTIL = 7
    DBG = 8
    APP = 9
    OTA = 10
    ZNP = 11
    BOOT = 13
    APP_CNF = 15
    PROTOBUF = 17
    ZGP = 21


KINDS = frozenset(kind.value for kind in Kind)
SUBSYSTEMS = frozenset(part.value for part in Subsystem)


class Frame(NamedTuple):
    """One frame; `header` is CMD0 << 8 | CMD1, so that SYS_PING is 0x2101 and its answer 0x6101."""

    header: int
    data: bytes = b''

    @property
    def kind(self) -> int:
        """One of `Kind`, where the frame is sound."""
        return self.header >> 8 & 0xE0

    @property
    def subsystem(self) -> int:
        """One of `Subsystem`, where the frame is sound."""
        return self.header >> 8 & 0x1F

    @property
    def exchange(self) -> int:
        """What a request and its answer have in common: subsystem << 8 | CMD1."""
        return self.header & 0x1FFF


def fcs(body: bytes) -> int:
    """XOR of all bytes; `body` is LEN to the last data byte, at most 256 bytes.

    They are folded upon each other as one long number: three times as fast for long frames as one after the other.
    """
    x = int.from_bytes(body, 'little')
    x ^= x >> 1024
    x ^= x >> 512
    x ^= x >> 256
    x ^= x >> 128
    x ^= x >> 64
    x ^= x >> 32
    x ^= x >> 16
    return (x ^ x >> 8) & 0xFF


def encode_frame(frame: Frame) -> bytes:
    """The bytes on the line; TrackingError where there are more data than a frame takes."""
    if len(frame.data) > MAX_DATA:
        raise TrackingError(f'a frame of {len(frame.data)} data bytes: at most {MAX_DATA} fit; send less at a time')
    body = bytes((len(frame.data), frame.header >> 8, frame.header & 0xFF)) + frame.data
    return bytes((SOF,)) + body + bytes((fcs(body),))
