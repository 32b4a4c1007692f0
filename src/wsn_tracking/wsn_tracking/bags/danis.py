"""Import the BLE tracks of Danis et al.: one bag a track, radios calibrated from histograms at rest alone."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

import numpy as np

from wsn_tracking.bags.danis_files import (
    TRACK,
    Devices,
    Links,
    Reception,
    find,
    read_devices,
    read_histograms,
    read_track,
)
from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, make_anchors
from wsn_tracking.sensing.calibration import fit_path_loss
from wsn_tracking.sensing.recording import Message, Recording, Truth
from wsn_tracking.sensing.values import Request, Rssi

SOURCE = 'github philotuxo/Position-Annotated-BLE-RSSI-Dataset @77474b69'
AREA = '0 0 20.66 17.64'  # [m]
HEIGHT = 1.8  # [m] at which the beacon was carried
TARGET = 1
PACKET_S = 0.1  # one packet reaches all receivers within 11 ms, the next comes 440 ms later


def import_danis(src: Path | str, out: Path | str) -> list[Path]:
    """Write `out`/danis_<track> for every track found below `src`; returns the folders.

    A packet of the beacon is an epoch, its stamp the first reception. Lines that cannot be used are counted
    in the bag's metadata (`import_dropped`). Raises TrackingError where files are missing or a bag exists.
    """
    sources = find(Path(src))
    devices = read_devices(sources.devices)
    anchors = calibrated(devices, read_histograms(sources.histograms, devices))
    bags = []
    for track in sources.tracks:
        receptions, dropped = read_track(track, devices)
        if not receptions:
            reasons = ', '.join(f'{reason} {count}' for reason, count in sorted(dropped.items()))
            raise TrackingError(f'{track} holds no usable line ({reasons or "it is empty"})')
        bag = Path(out) / f'danis_{track.name[: -len(TRACK)]}'
        save(bag, recording(receptions, anchors, dropped))
        bags.append(bag)
    return bags


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


def recording(receptions: list[Reception], anchors: Anchors, dropped: dict[str, int]) -> Recording:
    """Receptions in the order of time as epochs, with the truth at the epochs' stamps."""
    counter: Counter[int] = Counter()
    packets: list[Message] = []
    for reception in receptions:
        seq = counter[reception.node_id]
        counter[reception.node_id] += 1
        packets.append(Rssi(reception.stamp_ns, reception.node_id, TARGET, seq, 0, reception.rssi_dbm))
    metadata = {
        'entry_level': 'rssi',
        'area': AREA,
        'target_height': f'{HEIGHT:g}',
        'configuration': 'danis_central',
        'source': SOURCE,
        'import_dropped': ', '.join(f'{reason} {count}' for reason, count in sorted(dropped.items())) or 'nothing',
    }
    bare = Recording(anchors, 'rssi', tuple(packets), {}, metadata, {})
    messages = with_epoch_ends(bare, PACKET_S).messages
    stamp_of = {m.seq: m.stamp_ns for m in messages if isinstance(m, Request)}
    stamps = np.array(list(stamp_of.values()), dtype=np.int64)
    place = {reception.stamp_ns: reception.position for reception in reversed(receptions)}  # the first counts
    positions = np.array([place[stamp] for stamp in stamps.tolist()])
    truth = Truth(TARGET, stamps, positions, np.full(positions.shape, np.nan))
    if stamps.size > 1:
        metadata['period'] = f'{np.median(np.diff(stamps)) / 1e9:.4f}'
    return bare._replace(
        # a measurement answers its request: their stamps are equal (RssiMeasurement.msg)
        messages=tuple(m._replace(stamp_ns=stamp_of[m.request_seq]) if isinstance(m, Rssi) else m for m in messages),
        truth={TARGET: truth},
    )
