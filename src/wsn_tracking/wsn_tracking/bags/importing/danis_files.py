"""The files of the BLE tracks of Danis et al.: receivers, static histograms, tracks.

Cite Danis et al., Pervasive and Mobile Computing 81, 2022 (CC0). `tetam.dev` lists receivers and beacons,
`*.hst` holds histograms of the signal strength at known points, `*_all_sensors.mbd` one reception a line.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Mapping
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.bags.importing.common import comma_separated, is_called, lines_of, numbered
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats

TRACK = '_all_sensors.mbd'
CUT = 0.01  # share of packets in the lowest bin beyond which a histogram has lost a tail that matters
RSSI_LIMITS = (-127, 20)  # [dBm] what a BLE receiver can report


class Receiver(NamedTuple):
    """A fixed receiver."""

    node_id: int
    position: tuple[float, float, float]  # [m]


class Devices(NamedTuple):
    """Who takes part, by MAC address in small letters."""

    receivers: dict[str, Receiver]
    beacons: tuple[str, ...]


class Links(NamedTuple):
    """Static histograms of one receiver, a row a point."""

    distances: Floats  # (K,) [m], three-dimensional
    mean_dbm: Floats  # (K,)
    std_db: Floats  # (K,) of the packets at one point
    complete: Floats  # (K,) 1, or 0 where the histogram is cut off below its lowest bin
    points: Floats  # (K, 3) [m]


class Reception(NamedTuple):
    """One line of a track."""

    stamp_ns: int
    node_id: int
    rssi_dbm: float
    position: tuple[float, float, float]  # [m], truth


class Sources(NamedTuple):
    """Which files of a folder are used."""

    devices: Path
    histograms: Path
    tracks: tuple[Path, ...]


def find(src: Path) -> Sources:
    """Look through a folder of any layout (ours is flat, upstream's is a tree)."""
    if not src.is_dir():
        raise TrackingError(f'{src} is no folder: the folder of the BLE tracks is expected')
    files = sorted(path for path in src.rglob('*') if path.is_file())
    devices = [path for path in files if is_called(path, '*.dev')]
    histograms = [p for p in files if is_called(p, '*.hst') and 'set_1' in p.relative_to(src).as_posix().lower()]
    tracks = [path for path in files if is_called(path, f'*{TRACK}')]
    wanted = {'*.dev': devices, '*.hst with set_1 in its path': histograms, f'*{TRACK}': tracks}
    missing = [name for name, found in wanted.items() if not found]
    if missing:
        raise TrackingError(
            f'{src} holds no {", no ".join(missing)} (looked for {", ".join(wanted)} in all its folders): '
            'give the folder of the BLE tracks'
        )
    return Sources(_best(devices), _best(histograms), tuple(tracks))


def _best(paths: list[Path]) -> Path:
    """The file that upstream calls tetam, else the first."""
    return min(paths, key=lambda path: ('tetam' not in path.name.lower(), path.as_posix()))


def _sections(path: Path) -> dict[str, Any]:
    """Lines `name:JSON` of a .dev or .hst file."""
    sections = {}
    for number, line in numbered(path):
        name, colon, content = line.partition(':')
        if not colon or not name.strip():
            continue
        try:
            sections[name.strip()] = json.loads(content)
        except (ValueError, RecursionError) as error:
            raise TrackingError(
                f'{path}, line {number}, section {name.strip()!r}: JSON is expected: {error}'
            ) from error
    return sections


def read_devices(path: Path) -> Devices:
    """Receivers (node id: the number in the alias, sensor10 is 10) and beacons of a .dev file."""
    sections = _sections(path)
    receivers = {}
    try:
        for mac, (position, _, alias) in sections['Dongles'].items():
            number = re.fullmatch(r'\D*(\d+)', alias)
            x, y, z = (float(value) for value in position)
            if number is None or not all(map(math.isfinite, (x, y, z))):
                raise ValueError(f'receiver {mac} has alias {alias!r} at {position}')  # noqa: TRY301
            receivers[mac.lower()] = Receiver(int(number[1]), (x, y, z))
        beacons = tuple(mac.lower() for mac in sections['Beacons'])
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        raise TrackingError(
            f'{path} describes no receivers as expected (Dongles: MAC: [[x, y, z], colour, alias]): {error}'
        ) from error
    if not receivers or not beacons:
        raise TrackingError(f'{path} lists {len(receivers)} receivers and {len(beacons)} beacons: some expected')
    return Devices(receivers, beacons)


def read_histograms(path: Path, devices: Devices) -> dict[int, Links]:
    """Histograms of every receiver by node id.

    A histogram has one entry fewer than `Bins`: those are edges, a whole dBm falls on the lower one. Packets
    below the lowest edge are not in it: where the lowest bin holds more than CUT, the mean is too high.
    """
    sections = _sections(path)
    rows: dict[int, list[tuple[float, ...]]] = {}
    try:
        levels = np.asarray(sections['Bins'][:-1], dtype=np.float64)
        for point, by_mac in sections['Fingerprints'].items():
            place = np.array([float(value) for value in point.strip('() ').split(',')])
            for mac, by_beacon in by_mac.items():
                receiver = devices.receivers.get(mac.lower())
                if receiver is not None:
                    distance = float(np.linalg.norm(place - np.array(receiver.position)))
                    for pmf in by_beacon.values():
                        row = (*_moments(distance, levels, pmf), *place.tolist())
                        rows.setdefault(receiver.node_id, []).append(row)
    except (KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        raise TrackingError(
            f'{path} holds no histograms as expected (Bins, Fingerprints: point: MAC: beacon: pmf): {error}'
        ) from error
    absent = {r.node_id for r in devices.receivers.values()} - set(rows)
    if absent:
        raise TrackingError(f'{path} has no histogram of receivers {sorted(absent)}: they cannot be calibrated')
    tables = {node: np.array(links) for node, links in sorted(rows.items())}
    return {node: Links(*table.T[:4], table[:, 4:]) for node, table in tables.items()}  # type: ignore[call-arg]


def _moments(distance: float, levels: Floats, pmf: Any) -> tuple[float, float, float, float]:
    share = np.asarray(pmf, dtype=np.float64)
    total = share.sum()
    if share.shape != levels.shape or not np.isfinite(total) or total <= 0.0 or share.min() < 0.0:
        return distance, math.nan, math.nan, 0.0
    mean = float(share @ levels / total)
    variance = float(share @ (levels - mean) ** 2 / total)
    return distance, mean, math.sqrt(variance), float(share[0] <= CUT * total)


def read_track(path: Path, devices: Devices) -> tuple[list[Reception], dict[str, int]]:
    """Receptions of a track in the order of their stamps, and how many lines were left out, by reason."""
    receptions: list[Reception] = []
    dropped: Counter[str] = Counter()
    for line in lines_of(path):
        reception = _reception(comma_separated(line), devices.receivers, devices.beacons)
        if isinstance(reception, str):
            dropped[reception] += 1
        else:
            receptions.append(reception)
    receptions.sort(key=lambda reception: reception.stamp_ns)
    return receptions, dict(dropped)


def _reception(cells: list[str], receivers: Mapping[str, Receiver], beacons: tuple[str, ...]) -> Reception | str:
    """The reception, or the reason why the line is left out."""
    if len(cells) < 7:
        return 'too_few_columns'
    try:
        stamp = Decimal(cells[0])  # a float holds no nanoseconds
        rssi, x, y, z = (float(cell) for cell in cells[3:7])
    except (ValueError, InvalidOperation):
        return 'not_a_number'
    if not stamp.is_finite() or not 0 <= stamp < 2**31 or not all(map(math.isfinite, (x, y, z))):
        return 'absurd_number'
    if not RSSI_LIMITS[0] <= rssi <= RSSI_LIMITS[1]:
        return 'absurd_rssi'
    receiver = receivers.get(cells[1].lower())
    if receiver is None:
        return 'unknown_receiver'
    if cells[2].lower() not in beacons:
        return 'unknown_beacon'
    return Reception(round(stamp * 10**9), receiver.node_id, rssi, (x, y, z))
