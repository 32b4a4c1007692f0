"""Captured frames, frames of our own, and streams of them."""

import json
from pathlib import Path

from hypothesis import HealthCheck, settings

from wsn_tracking.zstack.commands import AfIncomingMsg, encode
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.parser import Parser
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.records import RssiRecord

VECTORS = {row['id']: row for row in json.loads((Path(__file__).parent / 'znp_frames.json').read_text('utf-8'))}
BYTES = {name: bytes.fromhex(row['hex']) for name, row in VECTORS.items()}

properties = settings(max_examples=100, suppress_health_check=list(HealthCheck))


def report_payload(node=3, seq=1, t_ms=1000, rssi=-60, beacon=9, robot=1, **more):
    record = RssiRecord(robot, 7, rssi, 5, 0.5, beacon)
    return Payload(PayloadType.RSSI, node, seq, t_ms, (record,), **more)


def message(payload, src=0x143E, ticks=3125, lqi=105, cluster=0x10, endpoint=0xE8):
    """AF_INCOMING_MSG that carries a payload."""
    data = payload if isinstance(payload, bytes) else encode_payload(payload)
    return AfIncomingMsg(0, cluster, src, endpoint, endpoint, 0, lqi, 0, ticks, 0, data, src, 29)


def line_bytes(command):
    return encode_frame(command if isinstance(command, Frame) else encode(command))


def parse(stream):
    """All frames of a stream that has ended."""
    parser = Parser()
    return [*parser.feed(stream, 0.0), *parser.flush()]


def is_subsequence(few, many):
    rest = iter(many)
    return all(item in rest for item in few)
