"""Import the log of ZigNav: a ZigBee sink that collects what seven nodes at rest read of each other.

experiment_data of EmbeddedAndMultisensorSystemsLab/ZigNav (LGPL v3; cite doi 10.5281/zenodo.1147144). A line is
`Time: <tick> NODE1: [ r11, ..., r18; ...; r81, ..., r88]`, row the reading node, 99 where nothing was read;
`AP_Pixel_Based_Locations.txt` holds `px;py;name;id`, y downwards, `Area_dimension.txt` the scale of the picture.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from wsn_tracking.bags.importing.common import (
    Dropped,
    find,
    lines_of,
    nanoseconds,
    numbered,
    numbers,
    recording,
    track,
    unusable,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Epoch, Rssi

SOURCE = 'github EmbeddedAndMultisensorSystemsLab/ZigNav @7b07bf87'
TARGET = 1  # the node that upstream calls mobile; it stands still here
NODES = 8  # rows and columns
NOTHING = 99.0
RSSI_LIMITS = (-127.0, 0.0)  # [dBm] what these nodes can read
TICK_S = 1200.0 / 4199.0  # upstream speaks of a test of 20 minutes; its log spans 4199 ticks
LINE = re.compile(r'Time:\s*(\S+)\s+NODE\d+:\s*\[(.*)\]')


class Plan(NamedTuple):
    """Where the nodes are."""

    positions: dict[int, tuple[float, float]]  # [m], y upwards
    area: str  # metadata


def load(src: Path) -> Recording:
    """What the fixed nodes with a known place read of node 1; its place is the truth of every line.

    A row with an impossible value was damaged on the wire: the value is counted (`absurd_rssi`), and none
    of its row is used (`damaged_row`). Nodes without a place are counted as well (`no_position`).
    """
    log, folder = find(src, 'ZigNav_logs*.txt'), src if src.is_dir() else src.parent
    plan = read_plan(find(folder, 'AP_Pixel_Based_Locations.txt'), find(folder, 'Area_dimension.txt'))
    dropped: Dropped = Counter()
    epochs = []
    for line in lines_of(log):
        match = LINE.fullmatch(line)
        try:
            if match is None:
                raise ValueError('no_record')  # noqa: TRY301
            (tick,) = numbers([match[1]], limit=1e9)
            epochs.append(_epoch(nanoseconds(tick * TICK_S), match[2].split(';'), plan, dropped))
        except ValueError as reason:
            dropped[str(reason)] += 1
    fixed = {node: place for node, place in plan.positions.items() if node != TARGET}
    place = (*plan.positions[TARGET], 0.0)
    truth = track(TARGET, [(epoch.stamp_ns, place) for epoch in epochs])
    metadata = {'area': plan.area, 'target_height': '0', 'configuration': 'zignav', 'source': SOURCE}
    return recording(epochs, make_anchors(list(fixed), list(fixed.values())), [truth], metadata, dropped)


def read_plan(places: Path, dimension: Path) -> Plan:
    """Pixels as metres."""
    try:
        width, height, pixels, metres = numbers(lines_of(dimension)[1].split(','))
        scale = metres / pixels
    except (ValueError, IndexError, ZeroDivisionError) as error:
        raise TrackingError(
            f'{dimension} tells no width,height,pixels,metres in its second line as expected: {error}'
        ) from None
    positions = {}
    for line, text in numbered(places):
        try:
            x, y, _, number = text.split(';')
            px, py, node = numbers([x, y, number])
        except ValueError as reason:
            raise unusable(places, line, 'px;py;name;id are', reason) from None
        positions[int(node)] = (px * scale, (height - py) * scale)
    area = f'0 0 {width * scale:.6g} {height * scale:.6g}'
    if TARGET not in positions or len(positions) < 2 or not (scale > 0.0 and width > 0.0 and height > 0.0):
        raise TrackingError(f'{places} places nodes {sorted(positions)}: node {TARGET} and others are expected')
    return Plan(positions, area)


def _epoch(stamp: int, rows: list[str], plan: Plan, dropped: Dropped) -> Epoch:
    """What one line tells; ValueError with the reason where it is no square of numbers."""
    matrix = [row.split(',') for row in rows]
    if len(matrix) != NODES or any(len(row) != NODES for row in matrix):
        raise ValueError('wrong_columns')
    packets = []
    for node, cells in enumerate(matrix, start=1):
        try:
            values = numbers(cells)
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        absurd = sum(value != NOTHING and not RSSI_LIMITS[0] <= value <= RSSI_LIMITS[1] for value in values)
        heard = values[TARGET - 1]
        dropped['absurd_rssi'] += absurd
        if node == TARGET or heard == NOTHING:
            continue
        if absurd:
            dropped['damaged_row'] += 1
        elif node not in plan.positions:
            dropped['no_position'] += 1
        else:
            packets.append(Rssi(stamp, node, TARGET, 0, 0, heard))
    return Epoch(TARGET, 0, stamp, tuple(packets))
