"""Import the flat of Kolakowski: six BLE anchors, a robot's LiDAR track, radios calibrated from the survey.

Cite Kolakowski, Sensors 21, 6270, 2021 (CC BY 4.0). A row of `test_robot_df.csv` and `calibration_df.csv` is
a window of 1/3 s: number, stamp [ns], x [m], heading [rad], y [m], rssi_1 ... rssi_6 [dBm], empty where no packet
came through. `anchors.csv`: id, x, y, z [m]. `layout.csv`: the corners of the walls, one closed line.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking.bags.importing.common import (
    Dropped,
    box,
    comma_separated,
    find,
    nanoseconds,
    numbered,
    numbers,
    recording,
    track,
    unusable,
)
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, make_anchors
from wsn_tracking.sensing.calibration import fit_path_loss
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.survey import Readings, Survey, survey_of
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
    corners = read_layout(find(src, 'layout.csv'))
    walls = [(*a, *b) for a, b in pairwise(corners)]
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


def read_layout(path: Path) -> list[list[float]]:
    """The corners of the walls, x, y [m]."""
    corners = _checked(path, ['x', 'y'])
    if len(corners) < 3:
        raise TrackingError(f'{path} holds {len(corners)} corners, a flat has at least 3')
    return corners


def survey(src: Path) -> tuple[Anchors, Survey]:
    """The anchors, and what the robot heard on its survey of the flat."""
    positions = read_anchors(find(src, 'anchors.csv'))
    windows = list(_windows(find(src, 'calibration_df.csv'), positions, Counter()))
    heard = [(w.x, w.y, HEIGHT, node, rssi) for w in windows for node, rssi in w.rssi_dbm.items()]
    table = np.array(heard, dtype=np.float64).reshape(-1, 5)
    anchors = make_anchors(list(positions), list(positions.values()))
    return anchors, survey_of(Readings(table[:, :3], table[:, 3].astype(np.int64), table[:, 4]), anchors)


def read_anchors(path: Path) -> Positions:
    """Where the anchors are."""
    positions = {int(number): xyz for number, *xyz in _checked(path, ['id', 'x', 'y', 'z'])}
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
    for _, (ts, x, y, *cells) in _table(path, ['ts', 'x', 'y', *(f'rssi_{node}' for node in positions)], dropped):
        try:
            stamp, place = nanoseconds(ts, -9), numbers([x, y])
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
        yield Window(stamp, place[0], place[1], heard)


def _checked(path: Path, names: list[str]) -> list[list[float]]:
    """The named columns of a table without which nothing can be used."""
    rows = []
    for number, cells in _table(path, names, Counter()):
        try:
            rows.append(numbers(cells))
        except ValueError as reason:
            raise unusable(path, number, f'{", ".join(names)} are', reason) from None
    return rows


def _table(path: Path, names: list[str], dropped: Dropped) -> Iterator[tuple[int, list[str]]]:
    """Line and named columns of every row."""
    lines = numbered(path)
    header = [name.lower() for name in comma_separated(lines[0][1])] if lines else []
    missing = [name for name in names if name not in header]
    if missing:
        raise TrackingError(f'{path} has no column {", ".join(missing)}: its first line names {header or "nothing"}')
    columns = [header.index(name) for name in names]
    for number, line in lines[1:]:
        cells = comma_separated(line)
        if len(cells) == len(header):
            yield number, [cells[column] for column in columns]
        else:
            dropped['wrong_columns'] += 1


def _rssi(cell: str) -> float:
    (value,) = numbers([cell])
    if not RSSI_LIMITS[0] <= value <= RSSI_LIMITS[1]:
        raise ValueError('absurd_rssi')
    return value
