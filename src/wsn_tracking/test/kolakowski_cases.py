"""A small flat: anchors, a survey of radios that are known, and a robot in it."""

from __future__ import annotations

import numpy as np

ANCHORS = {1: (0.0, 0.0, 2.0), 2: (6.0, 0.0, 2.3), 3: (0.0, 5.0, 2.5)}
P1, EXPONENT = -45.0, 2.2
HEADER = ',ts,x,heading,y,rssi_1,rssi_2,rssi_3\n'
T0 = 1628000000000000000  # [ns]


def rssi(node, x, y) -> float:
    return P1 - 10 * EXPONENT * np.log10(np.linalg.norm(np.array([x, y, 1.3]) - ANCHORS[node]))


def row(k, x=1.0, y=2.0, cells=('-50.0', '-60.5', '-70.25'), ts=None) -> str:
    digits = str(T0 + round(k * 1e9 / 3))
    return f'{k},{f"{digits[0]}.{digits[1:]}e+18" if ts is None else ts},{x},0.5,{y},{",".join(cells)}\n'


def files(rows=None) -> dict[str, str]:
    survey = [(1.0 + 0.5 * i, 0.5 + 0.5 * j) for i in range(9) for j in range(8)]
    return {
        'anchors.csv': 'id,x,y,z\n' + ''.join(f'{i},{x},{y},{z}\n' for i, (x, y, z) in ANCHORS.items()),
        'layout.csv': 'x,y\n0.0,0.0\n6.5,0.0\n6.5,5.5\n0.0,5.5\n0.0,0.0\n',
        'calibration/calibration_df.csv': HEADER
        + ''.join(row(k, x, y, [f'{rssi(i, x, y):.6f}' for i in ANCHORS]) for k, (x, y) in enumerate(survey)),
        'tests/test_robot_df.csv': HEADER
        + (row(0) + row(1, 1.5, cells=('', '-61', '')) + row(2, 2.0, cells=('', '', '')) if rows is None else rows),
    }


def robot() -> str:
    """Windows of a robot that drives along a wall for 20 s."""
    rng = np.random.default_rng(2)
    ways = [(k, 0.5 + 0.05 * k) for k in range(60)]
    cells = [[f'{rssi(i, x, 2.0) + rng.normal():.3f}' for i in ANCHORS] for _, x in ways]
    return HEADER + ''.join(row(k, x, 2.0, c) for (k, x), c in zip(ways, cells, strict=True))
