"""Small bags that the tests of bags/ share."""

from __future__ import annotations

from pathlib import Path

import pytest
from mcap.writer import Writer

from wsn_tracking.bags.messages import TruthPose, to_cdr, type_of
from wsn_tracking.bags.read import read
from wsn_tracking.bags.types import definition
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, make_anchors
from wsn_tracking.sensing.values import EpochEnd, Range, RangeBearing, Request, Rssi, TriggerReport

START = 1_700_000_000_123_456_789
SECOND = 1_000_000_000
NODES = (1, 2, 7)


def anchors() -> Anchors:
    return make_anchors(NODES, [[0.0, 0.0, 1.0], [3.5, 0.25, 2.0], [1.0, 4.0, 0.5]], n=[2.0, 2.5, 3.0])


def measurement(level: str, stamp: int, node: int, k: int, target: int = 1) -> Rssi | Range | RangeBearing:
    value = 50.0 + node + 0.125 * k
    if level == 'rssi':
        return Rssi(stamp, node, target, k, k, -value, 1.5, 2)
    if level == 'range':
        return Range(stamp, node, target, k, k, 2, value, 0.25, -value, 1)
    return RangeBearing(stamp, node, target, k, k, value, 0.5, (1.0, 0.0, 0.0, 2.0), arrived=node != 2)


def events(level: str = 'rssi', epochs: int = 5, ends: bool = True, target: int = 1) -> list[tuple[str, object, int]]:
    """(topic, value, log time) of a complete recording."""
    rows: list[tuple[str, object, int]] = [('anchors', anchors(), START)]
    for k in range(epochs):
        t = START + k * SECOND
        rows.append((f'truth/target_{target}', TruthPose(t, target, (0.1 * k, 1.0, 1.8), (0.1, 0.0, 0.0)), t))
        rows.append(('request', Request(t, target, k), t))
        rows += [(level, measurement(level, t, node, k, target), t + 1000 * node) for node in NODES]
        if level == 'range':
            rows.append(('trigger_report', TriggerReport(t, target, k, NODES, (k,) * 3, (9,), (3,)), t + 20_000))
        if ends:
            end = EpochEnd(t, target, k, level, NODES, (k,) * 3, k == epochs - 1)
            rows.append(('epoch_end', end, t + 30_000))
    return rows


def write(
    path: Path, rows: list[tuple[str, object, int]], metadata: dict[str, str] | None = None, prefix: str = ''
) -> Path:
    with BagWriter(path, metadata or {}) as bag:
        for topic, value, log_ns in rows:
            bag.write(prefix + topic, value, log_ns)
    return path


def mcap_of(path: Path) -> Path:
    return next(path.glob('*.mcap'))


def refused(path, *parts, **options):
    """The bag is refused in one line that says all of `parts`."""
    with pytest.raises(TrackingError) as error:
        read(path, **options)
    text = str(error.value)
    assert '\n' not in text
    for part in parts:
        assert part in text


def plain_mcap(path: Path, rows, topics=None, definitions=None, **options) -> Path:
    """A bare file by the mcap library, with its options; `definitions` replaces a type's definition."""
    with path.open('wb') as stream:
        mcap = Writer(stream, **options)
        mcap.start(profile='ros2', library='test')
        channels = {}
        for topic, value, log_ns in rows:
            name = type_of(value)
            if topic not in channels:
                text = (definitions or {}).get(name, definition(name))
                schema = mcap.register_schema((topics or {}).get(topic, name), 'ros2msg' if text else '', text.encode())
                channels[topic] = mcap.register_channel(topic, 'cdr', schema)
            mcap.add_message(channels[topic], log_ns, to_cdr(value, log_ns), log_ns)
        mcap.finish()
    return path
