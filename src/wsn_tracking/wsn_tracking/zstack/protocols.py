"""The three kinds of sink (zstack.md, section 1): bytes of the line in, reports out.

`znp` passes every message of the network on as AF_INCOMING_MSG; `mt_app` passes the payload on in a frame of its own;
`ascii` prints lines. What comes out is a report, a command (the sink speaks of itself), or a Bad that is to be counted.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.commands import AfIncomingMsg, Command, MtAppRsp, decode
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.lines import LineReader, decode_line
from wsn_tracking.zstack.parser import GAP_S, Parser
from wsn_tracking.zstack.payload import DOWN, Payload, decode_payload
from wsn_tracking.zstack.reports import Report

PROTOCOLS = ('znp', 'mt_app', 'ascii')


class Radio(NamedTuple):
    """What our messages bear, so that those of others are told from them."""

    endpoint: int = 0xE8
    profile: int = 0xBF01
    cluster: int = 0x0010
    default_radius: int = 30


Item = Report | Command | Bad
Tap = Callable[[Frame | bytes, Item], None]  # sees every frame or line, and what it is


class LineProtocol(Protocol):
    """Turns the bytes of the line into items; pure but for what it holds of an incomplete one."""

    @property
    def held(self) -> int:
        """Bytes that wait for more."""
        ...

    @property
    def counters(self) -> dict[str, int]:
        """What was seen so far."""
        ...

    def feed(self, data: bytes, now: float) -> list[Item]:
        """The items that are complete with `data`, read at `now` [s]; call it with b'' to have time pass."""
        ...

    def flush(self) -> list[Item]:
        """The items in what is held, when nothing more is to come."""
        ...


def protocol_of(name: str, radio: Radio, gap_s: float = GAP_S, tap: Tap = lambda raw, item: None) -> LineProtocol:
    """The protocol of that name, one of PROTOCOLS."""
    return AsciiProtocol(gap_s, tap) if name == 'ascii' else FrameProtocol(radio, gap_s, tap)


class FrameProtocol:
    """`znp` and `mt_app`: both speak in MT frames, and either may come."""

    def __init__(self, radio: Radio, gap_s: float, tap: Tap) -> None:
        self._parser = Parser(gap_s)
        self._radio = radio
        self._tap = tap

    @property
    def held(self) -> int:
        """Bytes that wait for the rest of their frame."""
        return self._parser.held

    @property
    def counters(self) -> dict[str, int]:
        """Those of the parser."""
        return self._parser.counters

    def feed(self, data: bytes, now: float) -> list[Item]:
        """As LineProtocol."""
        return self._items(self._parser.feed(data, now))

    def flush(self) -> list[Item]:
        """As LineProtocol."""
        return self._items(self._parser.flush())

    def _items(self, frames: list[Frame]) -> list[Item]:
        items = [item_of(frame, self._radio) for frame in frames]
        for frame, item in zip(frames, items, strict=True):
            self._tap(frame, item)
        return items


class AsciiProtocol:
    """`ascii`: a pause ends a line only where it is complete."""

    def __init__(self, gap_s: float, tap: Tap) -> None:
        self._reader = LineReader()
        self._gap_s = gap_s
        self._tap = tap
        self._last = 0.0

    @property
    def held(self) -> int:
        """Characters that wait for the end of their line."""
        return self._reader.held

    @property
    def counters(self) -> dict[str, int]:
        """Those of the reader of lines."""
        return self._reader.counters

    def feed(self, data: bytes, now: float) -> list[Item]:
        """As LineProtocol."""
        items: list[Item] = []
        if now - self._last > self._gap_s:
            items += self._items(self._reader.take_complete())
        if data:
            self._last = now
            items += self._items(self._reader.feed(data))
        return items

    def flush(self) -> list[Item]:
        """As LineProtocol."""
        return self._items(self._reader.flush())

    def _items(self, lines: list[bytes]) -> list[Item]:
        items: list[Item] = [decode_line(line) for line in lines]
        for line, item in zip(lines, items, strict=True):
            self._tap(line, item)
        return items


def item_of(frame: Frame, radio: Radio) -> Item:
    """The report in a frame, or the command that it is; messages of others are Bad."""
    command = decode(frame)
    if isinstance(command, AfIncomingMsg):
        return report_of(command, radio)
    if isinstance(command, MtAppRsp):
        if command.endpoint != radio.endpoint:
            return Bad('foreign_endpoint', f'endpoint {command.endpoint:#04x}')
        payload = _up(decode_payload(command.data))
        return payload if isinstance(payload, Bad) else Report(payload)
    return command


def report_of(message: AfIncomingMsg, radio: Radio) -> Report | Bad:
    """The report in a message of the network."""
    if message.dst_endpoint != radio.endpoint:
        return Bad('foreign_endpoint', f'endpoint {message.dst_endpoint:#04x}')
    if message.cluster != radio.cluster:
        return Bad('foreign_cluster', f'cluster {message.cluster:#06x}')
    payload = _up(decode_payload(message.data))
    if isinstance(payload, Bad):
        return payload
    hops = None if message.radius is None else max(radio.default_radius - message.radius, 1)
    return Report(payload, message.src, message.lqi, hops, message.timestamp, message.mac_src)


def _up(payload: Payload | Bad) -> Payload | Bad:
    if isinstance(payload, Payload) and payload.type in DOWN:
        return Bad('payload_direction', f'type {payload.type} is for nodes')
    return payload
