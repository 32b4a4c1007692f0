"""How many times faster than the line a sink's bytes are parsed."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from functools import partial

from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, cpu_seconds
from wsn_tracking.zstack.commands import AfIncomingMsg, encode
from wsn_tracking.zstack.frames import encode_frame
from wsn_tracking.zstack.parser import Parser
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.protocols import Item, Radio, protocol_of
from wsn_tracking.zstack.records import RssiRecord

GROUP = 'serial'
LINE = 115200 / 10  # [bytes/s] of 8N1
FASTER = 200.0
FRAMES = 2000
READ = 4096  # bytes at once
NODES = 12


def stream(frames: int = FRAMES) -> bytes:
    """Reports of twelve nodes, one robot each, as a sink passes them on."""
    draw = random.Random(1)
    return b''.join(_report(k % NODES, k // NODES, draw.randint(-95, -30)) for k in range(frames))


def _report(node: int, seq: int, rssi: int) -> bytes:
    payload = Payload(PayloadType.RSSI, node, seq, 100 * seq, (RssiRecord(1, 7, rssi, 1, None, seq % 256),))
    data, address = encode_payload(payload), 0x1000 + node
    message = AfIncomingMsg(0, 0x10, address, 0xE8, 0xE8, 0, 105, 0, 312 * seq, 0, data, address, 29)
    return encode_frame(encode(message))


def pieces(data: bytes) -> list[bytes]:
    """As they are read."""
    return [data[at : at + READ] for at in range(0, len(data), READ)]


def parsed(reads: Iterable[bytes]) -> int:
    """How many frames are found."""
    parser = Parser()
    return sum(len(parser.feed(data, 0.0)) for data in reads)


def decoded(reads: Iterable[bytes]) -> list[Item]:
    """Every report, with its payload."""
    protocol = protocol_of('znp', Radio())
    return [item for data in reads for item in protocol.feed(data, 0.0)]


def rows(sizes: Sizes) -> Iterable[Row]:
    """Reports to frames, and to payloads; and random bytes, in which there is nothing."""
    reports, noise = stream(), random.Random(2).randbytes(100_000)
    works: dict[str, tuple[Callable[[list[bytes]], object], bytes]] = {
        'parser: reports to frames': (parsed, reports),
        'the same, to payloads': (decoded, reports),
        'parser: random bytes': (parsed, noise),
    }
    contenders = {work: partial(do, pieces(data)) for work, (do, data) in works.items()}
    took = cpu_seconds(contenders, sizes)
    for work, (_, data) in works.items():
        goal = at_least(FASTER) if work.startswith('parser') else None
        yield Row(GROUP, work, 'x 115200 Bd', len(data) / took[work] / LINE, goal=goal)
