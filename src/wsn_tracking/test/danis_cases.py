"""A small set of BLE tracks: receivers, a survey of a radio that is known, and a track."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

BEACON = 'e78f135624ce'
RECEIVERS = {'aa01': ((0.0, 0.0, 1.0), 10), 'aa02': ((6.0, 0.0, 2.0), 11), 'aa03': ((0.0, 6.0, 2.0), 20)}
P1, EXPONENT, WITHIN = -58.0, 1.8, 3.0
T0 = 1581252284


def dev() -> str:
    dongles = {mac: [list(xyz), 255, f'sensor{node}'] for mac, (xyz, node) in RECEIVERS.items()}
    return f'Dongles:{json.dumps(dongles)}\nBeacons:{json.dumps({BEACON: [[], 1, "beacon1"]})}\n'


def hst() -> str:
    """Histograms of a radio that is known, on a grid of points."""
    edges = np.arange(-100.0, -19.0)
    prints = {}
    for x in range(1, 6):
        for y in range(1, 6):
            by_mac = {}
            for mac, (xyz, _) in RECEIVERS.items():
                d = np.linalg.norm(np.array([x, y, 1.85]) - xyz)
                z = (edges[:-1] - (P1 - 10 * EXPONENT * np.log10(d))) / WITHIN
                pmf = np.exp(-0.5 * z**2)
                by_mac[mac] = {BEACON: (pmf / pmf.sum()).tolist()}
            prints[f'({x}, {y}, 1.85)'] = by_mac
    return f'Bins:{json.dumps(edges.tolist())}\n{dev()}Fingerprints:{json.dumps(prints)}\n'


def line(t, mac='aa01', rssi=-70, beacon=BEACON, x=1.0, y=2.0, z=1.8) -> str:
    return f'{t},{mac},{beacon},{rssi},{x},{y},{z},1,0,0,0,1,0,0,0,1\n'


def track(packets=5) -> str:
    return ''.join(
        line(f'{T0 + 0.45 * k + 0.001 * i:.6f}', mac, -70 - i, x=1.0 + k)
        for k in range(packets)
        for i, mac in enumerate(RECEIVERS)
    )


def flat(root: Path, content=None) -> Path:
    for folder in ('cnf', 'hst', 'trk'):
        (root / folder).mkdir(parents=True)
    (root / 'cnf' / 'tetam.dev').write_text(dev())
    (root / 'hst' / 'set_1_tetam_multi_rssi.hst').write_text(hst())
    (root / 'hst' / 'set_1_links_summary.csv').write_text('not used')
    (root / 'trk' / 'short_all_sensors.mbd').write_text(track() if content is None else content)
    return root
