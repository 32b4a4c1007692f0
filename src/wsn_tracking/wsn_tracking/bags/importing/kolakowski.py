"""Import the flat of Kolakowski: six BLE anchors, a robot's LiDAR track, radios calibrated from the survey.

Cite Kolakowski, Sensors 21, 6270, 2021 (CC BY 4.0). A row of `test_robot_df.csv` and `calibration_df.csv` is
a window of 1/3 s: number, stamp [ns], x [m], heading [rad], y [m], rssi_1 ... rssi_6 [dBm], empty where no packet
came through. `anchors.csv`: id, x, y, z [m]. `layout.csv`: the corners of the walls, one closed line.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking.bags.importing.common import Dropped, box, find, lines_of, nanoseconds, numbers, recording, track
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, make_anchors
from wsn_tracking.sensing.calibration import fit_path_loss
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Epoch, Rssi

SOURCE = 'github marckolak/ble-rss-fingerprints-calib2021 @0a69aaa7'
HEIGHT = 1.3  # [m] of the tag on the robot
TARGET = 1
RSSI_LIMITS = (-127.0, 20.0)  # [dBm] what a BLE receiver can report

Positions = dict[int, list[float]]  # anchor id -> x, y, z [m]


class Window(NamedTuple):
    """One row: what was heard at one place."""

    stamp_ns: int
    x: float
    y: float
    rssi_dbm: dict[int, float]  # by anchor id


def load(src: Path) -> Recording:
    """The robot's track; every anchor's path loss comes from the survey alone, never from the track."""
    dropped: Dropped = Counter()
    positions = read_anchors(find(src, 'anchors.csv'))
    anchors = calibrated(positions, list(_windows(find(src, 'calibration_df.csv'), positions, Counter())))
    windows = list(_windows(find(src, 'test_robot_df.csv'), positions, dropped))
    corners = [numbers(corner) for corner in _table(find(src, 'layout.csv'), ['x', 'y'], Counter())]
    if len(corners) < 3:
        raise TrackingError(f'{src}: layout.csv holds {len(corners)} corners, a flat has at least 3')
    walls = [(*a, *b) for a, b in zip(corners, corners[1:], strict=False)]
    metadata = {
        'area': box(corners),
        'target_height': f'{HEIGHT:g}',
        'configuration': 'kolakowski',
        'source': SOURCE,
        'walls': '; '.join(' '.join(f'{value:g}' for value in wall) for wall in walls),
    }
    epochs = [
        Epoch(TARGET, 0, w.stamp_ns, tuple(Rssi(w.stamp_ns, i, TARGET, 0, 0, y) for i, y in w.rssi_dbm.items()))
        for w in windows
    ]
    truth = track(TARGET, [(w.stamp_ns, (w.x, w.y, HEIGHT)) for w in windows])
    return recording(epochs, anchors, [truth], metadata, dropped)


def read_anchors(path: Path) -> Positions:
    """Where the anchors are."""
    positions = {}
    for cells in _table(path, ['id', 'x', 'y', 'z'], Counter()):
        try:
            number, *xyz = numbers(cells)
        except ValueError as error:
            raise TrackingError(f'{path}: row {cells} is no id, x, y, z ({error})') from None
        positions[int(number)] = xyz
    if not positions:
        raise TrackingError(f'{path} lists no anchor: rows of id, x, y, z are expected')
    return positions


def calibrated(positions: Positions, survey: list[Window]) -> Anchors:
    """Each anchor with the radio that its column of the survey shows; sigma_db is that of one window."""
    fits = {}
    for node, place in positions.items():
        heard = [(w.x, w.y, w.rssi_dbm[node]) for w in survey if node in w.rssi_dbm]
        x, y, rssi = np.array(heard, dtype=np.float64).reshape(-1, 3).T
        away = np.column_stack([x - place[0], y - place[1], np.full(x.shape, HEIGHT - place[2])])
        fits[node] = fit_path_loss(np.linalg.norm(away, axis=1), rssi)
    return make_anchors(
        list(positions),
        list(positions.values()),
        p1_dbm=[fit.p1_dbm for fit in fits.values()],
        n=[fit.n for fit in fits.values()],
        sigma_db=[fit.sigma_db for fit in fits.values()],
    )


def _windows(path: Path, positions: Positions, dropped: Dropped) -> Iterator[Window]:
    names = ['ts', 'x', 'y', *(f'rssi_{node}' for node in positions)]
    for ts, x, y, *cells in _table(path, names, dropped):
        try:
            # written as 1.628e+18 [ns]
            stamp = nanoseconds(f'{ts}e-9' if 'e' not in ts.lower() else _shifted(ts))
            place = numbers([x, y])
        except ValueError as reason:
            dropped[str(reason)] += 1
            continue
        heard = {}
        for node, cell in zip(positions, cells, strict=True):
            try:
                if cell:
                    heard[node] = _rssi(cell)
            except ValueError as reason:
                dropped[str(reason)] += 1
        yield Window(stamp, *place, heard)


def _rssi(cell: str) -> float:
    (value,) = numbers([cell])
    if not RSSI_LIMITS[0] <= value <= RSSI_LIMITS[1]:
        raise ValueError('absurd_rssi')
    return value
