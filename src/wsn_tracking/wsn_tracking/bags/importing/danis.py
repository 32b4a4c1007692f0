"""Import the BLE tracks of Danis et al.: one bag a track, radios calibrated from histograms at rest alone."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wsn_tracking.bags.importing.common import Dropped, grouped, recording, track
from wsn_tracking.bags.importing.danis_files import (
    TRACK,
    Devices,
    Links,
    Reception,
    find,
    read_devices,
    read_histograms,
    read_track,
)
from wsn_tracking.models.anchors import Anchors, make_anchors
from wsn_tracking.sensing.calibration import fit_path_loss
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.survey import Survey, survey_of_places
from wsn_tracking.sensing.values import Rssi

SOURCE = 'github philotuxo/Position-Annotated-BLE-RSSI-Dataset @77474b69'
AREA = '0 0 20.66 17.64'  # [m]
HEIGHT = 1.8  # [m] at which the beacon was carried
TARGET = 1
PACKET_S = 0.1  # one packet reaches all receivers within 11 ms, the next comes 440 ms later


def tracks(src: Path) -> Iterator[tuple[str, Recording]]:
    """Name (danis_<track>) and recording of every track found below `src`.

    A packet of the beacon is an epoch, its stamp the first reception. Lines that cannot be used are counted
    in the metadata (`import_dropped`). Raises TrackingError where files are missing.
    """
    sources = find(src)
    devices = read_devices(sources.devices)
    anchors = calibrated(devices, read_histograms(sources.histograms, devices))
    for path in sources.tracks:
        receptions, dropped = read_track(path, devices)
        name = path.name[: path.name.lower().index(TRACK)]
        yield f'danis_{name}', _recording(path, receptions, anchors, Counter(dropped))


def survey(src: Path) -> tuple[Anchors, Survey]:
    """The receivers, and the histograms as a survey; cut ones are left out."""
    sources = find(src)
    devices = read_devices(sources.devices)
    links = read_histograms(sources.histograms, devices)
    anchors = calibrated(devices, links)
    places = sorted({tuple(point) for link in links.values() for point in link.points.tolist()})
    row = {place: k for k, place in enumerate(places)}
    values, scatter, counts = np.full((3, len(places), anchors.ids.size), np.nan)
    for column, node in enumerate(anchors.ids.tolist()):
        link = links[node]
        at = [row[tuple(point)] for point in link.points.tolist()]
        values[at, column], scatter[at, column] = link.mean_dbm, link.std_db
        counts[at, column] = np.where(link.complete > 0.0, np.inf, 0.0)  # thousands, which are not told
    return anchors, survey_of_places(anchors, places, values, scatter, np.nan_to_num(counts, posinf=np.inf))


def calibrated(devices: Devices, links: dict[int, Links]) -> Anchors:
    """The receivers with the radio of each.

    sigma_db is that of ONE packet at a random place: the scatter of the points' means about the curve and
    the scatter of the packets at a point, in quadrature. Cut histograms are left out.
    """
    receivers = sorted(devices.receivers.values())
    rows = []
    for receiver in receivers:
        link = links[receiver.node_id]
        fit = fit_path_loss(link.distances, link.mean_dbm, link.complete)
        within = float(np.sqrt(np.mean(link.std_db[link.complete > 0.0] ** 2)))
        rows.append((fit.p1_dbm, fit.n, math.hypot(fit.sigma_db, within)))
    p1_dbm, n, sigma_db = np.array(rows).T
    positions = [receiver.position for receiver in receivers]
    return make_anchors([r.node_id for r in receivers], positions, p1_dbm=p1_dbm, n=n, sigma_db=sigma_db)


def _recording(path: Path, receptions: list[Reception], anchors: Anchors, dropped: Dropped) -> Recording:
    """Receptions in the order of time as epochs, with the truth at the epochs' stamps."""
    packets = [Rssi(r.stamp_ns, r.node_id, TARGET, 0, 0, r.rssi_dbm) for r in receptions]
    epochs = grouped(packets, PACKET_S)
    stamps = {epoch.stamp_ns for epoch in epochs}
    truth = track(TARGET, [(r.stamp_ns, r.position) for r in receptions if r.stamp_ns in stamps])
    metadata = {
        'area': AREA,
        'target_height': f'{HEIGHT:g}',
        'configuration': 'danis_central',
        'source': f'{SOURCE} {path.name}',
    }
    return recording(epochs, anchors, [truth], metadata, dropped)
