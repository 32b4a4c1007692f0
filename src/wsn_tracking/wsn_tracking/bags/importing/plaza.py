"""Import a plaza of Djugash: an autonomous lawnmower ranges four radio beacons out of doors.

examples/Data/Plaza*_.mat of borglab/gtsam. GT: stamp [s], x, y [m], heading [rad]; TL: beacon, x, y [m];
TD: stamp [s], sender, beacon, range [m]. The odometry (DR, DRp) is left out: no tracker here takes it.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from wsn_tracking.bags.importing.common import (
    MAX_M,
    Dropped,
    box,
    find,
    nanoseconds,
    numbers,
    positive,
    recording,
    singles,
    track,
)
from wsn_tracking.bags.importing.matlab import read_tables
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats, make_anchors
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Modality, Range

SOURCE = 'github borglab/gtsam @0ffe6c93'
TARGET = 1
MARGIN = 5.0  # [m] by which the mower may leave the rectangle of the beacons
COLUMNS = {'TL': 3, 'TD': 4, 'GT': 3}


def load(src: Path) -> Recording:
    """Every range is an epoch of its own, but for those of one stamp."""
    path = find(src, 'Plaza*.mat')
    tables = _tables(path)
    dropped: Dropped = Counter()
    beacons = {int(node): (x, y) for node, x, y in tables['TL'][:, :3].tolist()}
    packets = []
    for stamp, _, node, metres in tables['TD'][:, :4].tolist():
        try:
            at = nanoseconds(stamp)
            if node not in beacons:
                raise ValueError('unknown_beacon')  # noqa: TRY301
            packet = Range(at, int(node), TARGET, 0, 0, Modality.UWB, positive(metres))
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        packets.append(packet)
    truth = []
    for stamp, x, y in tables['GT'][:, :3].tolist():
        try:
            truth.append((nanoseconds(stamp), (*numbers([x, y]), 0.0)))
        except ValueError as reason:
            dropped[f'truth_{reason}'] += 1
    anchors = make_anchors(list(beacons), list(beacons.values()))
    metadata = {
        'area': box(anchors.positions, MARGIN),
        'target_height': '0',
        'configuration': 'plaza',
        'source': f'{SOURCE} {path.name}',
    }
    return recording(singles(packets, dropped), anchors, [track(TARGET, truth)], metadata, dropped)


def _tables(path: Path) -> dict[str, Floats]:
    """The tables that are used, at least as wide as expected."""
    tables = read_tables(path)
    for name, width in COLUMNS.items():
        shape = tables[name].shape if name in tables else (0, 0)
        if shape[0] < 1 or shape[1] < width:
            raise TrackingError(f'{path} holds no table {name} of at least {width} columns of numbers')
    if not np.all(np.abs(tables['TL']) <= MAX_M):
        raise TrackingError(f'{path}: its table TL holds no rows of beacon, x, y')
    return tables
