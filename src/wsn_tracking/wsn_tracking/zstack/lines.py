"""Reports of a sink that prints them: `$WSN,<ver>,<node>,<robot>,<seq>,<t_ms>,<age_ms>,<rssi_dbm>,<lqi>,<hops>*HH`.

At most 120 characters and a line end; HH is the XOR of what stands between `$` and `*`; an empty field is unknown;
other lines are not ours (zstack.md, section 1).
"""

from __future__ import annotations

import re

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.frames import fcs
from wsn_tracking.zstack.payload import VERSION, Payload, PayloadType
from wsn_tracking.zstack.records import AGE_OLDER, RSSI_INVALID, RssiRecord
from wsn_tracking.zstack.reports import Report

MAX_LINE = 120
SHAPE = re.compile(rb'\$(WSN,([^*]*))\*([0-9A-Fa-f]{2})')
# lowest and highest value of ver, node, robot, seq, t_ms, age_ms, rssi_dbm, lqi, hops
LIMITS = ((0, 255), *[(0, 0xFFFF)] * 3, (0, 0xFFFFFFFF), (0, 0xFFFFFFFF), (-128, 127), (0, 255), (0, 255))
NUMBER = re.compile(rb'[+-]?[0-9]{1,10}')


def encode_line(report: Report) -> bytes:
    """The line of a report with at most one record, CR LF included."""
    payload = report.payload
    if len(payload.records) > 1:
        raise TrackingError(f'{len(payload.records)} records in a line: expected at most one; send a line for each')
    record = payload.records[0] if payload.records else None
    if record is not None and not isinstance(record, RssiRecord):
        raise TrackingError(f'a {type(record).__name__} in a line: lines carry signal strengths only')
    robot = (record.robot_id, record.age_ms, record.rssi_dbm) if record else (None, None, None)
    values = (VERSION, payload.node_id, robot[0], payload.seq, payload.t_ms, *robot[1:], report.lqi, report.hops)
    body = b'WSN,' + b','.join(b'' if value is None else b'%d' % value for value in values)
    return b'$%s*%02X\r\n' % (body, fcs(body))


def decode_line(line: bytes) -> Report | Bad:
    """The report of a line without its end; Bad with reason line_checksum, line_version or line_field."""
    match = SHAPE.fullmatch(line)
    if match is None:
        return Bad('line_field', repr(line))
    if fcs(match[1]) != int(match[3], 16):
        return Bad('line_checksum', f'{match[3].decode()}, {fcs(match[1]):02X} expected')
    texts = match[2].split(b',')
    if texts[0] != b'%d' % VERSION:
        return Bad('line_version', f'version {texts[0]!r}, {VERSION} expected')
    if len(texts) != len(LIMITS):
        return Bad('line_field', f'{len(texts)} fields, {len(LIMITS)} expected')
    values = [_number(text, *limits) for text, limits in zip(texts, LIMITS, strict=True)]
    for text, value in zip(texts, values, strict=True):
        if text and value is None:
            return Bad('line_field', f'{text!r} in {line!r}')
    _, node, robot, seq, t_ms, age, rssi, lqi, hops = values
    if node is None:
        return Bad('line_field', f'no node in {line!r}')
    age = None if age is None or age >= AGE_OLDER else age
    record = () if robot is None else (RssiRecord(robot, age, None if rssi == RSSI_INVALID else rssi),)
    kind = PayloadType.RSSI if record else PayloadType.HEARTBEAT
    return Report(Payload(kind, node, seq, t_ms, record), lqi=lqi, hops=hops, per_robot=True)


def _number(text: bytes, low: int, high: int) -> int | None:
    if not NUMBER.fullmatch(text):
        return None
    value = int(text)
    return value if low <= value <= high else None


class LineReader:
    """Lines out of a stream; each `$` begins one anew, whatever came before it. Holds at most 120 bytes."""

    def __init__(self) -> None:
        self.counters = dict.fromkeys(('lines', 'garbage_bytes', 'long_lines'), 0)
        self._held = b''

    @property
    def held(self) -> int:
        """Characters that wait for the end of their line."""
        return len(self._held)

    def feed(self, data: bytes) -> list[bytes]:
        """The complete lines that begin like ours, without their ends."""
        lines = []
        pieces = re.split(rb'([\r\n$])', self._held + data)
        line = pieces[0]
        for end, piece in zip(pieces[1::2], pieces[2::2], strict=True):
            if line:
                lines += self._complete(line)
            line = b'$' + piece if end == b'$' else piece
        if len(line) > MAX_LINE or (line and not b'$WSN,'.startswith(line[:5])):
            self.counters['long_lines'] += line[:5] == b'$WSN,'
            self.counters['garbage_bytes'] += len(line)
            line = b''
        self._held = line
        return lines

    def take_complete(self) -> list[bytes]:
        """The held line, where only its end is missing."""
        return self.flush() if SHAPE.fullmatch(self._held) else []

    def flush(self) -> list[bytes]:
        """What is held, when nothing more is to come."""
        line, self._held = self._held, b''
        return self._complete(line) if line else []

    def _complete(self, line: bytes) -> list[bytes]:
        if line.startswith(b'$WSN,') and len(line) <= MAX_LINE:
            self.counters['lines'] += 1
            return [line]
        self.counters['garbage_bytes'] += len(line)
        return []
