"""docs/datasets.md says of the recordings what they show; a row of the page each."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from import_cases import real_data

from wsn_tracking.bags.importing import kolakowski, lias
from wsn_tracking.bags.importing.common import numbers, track
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.filters.least_squares import least_squares
from wsn_tracking.sensing.calibration import fit_path_loss

PAGE = (Path(__file__).resolve().parents[3] / 'docs' / 'datasets.md').read_text('utf-8')
SLICE_NS = 15_000_000_000  # what biases are of


@pytest.fixture(scope='module')
def trolley():
    """Stamps, ranges (K, 8, 3), true centroids (K, 3) and headings of the motion capture (K,), at 10 Hz."""
    ranged = real_data('lias_uwb_planar') / 'UWB_dynamic_exp_mid.csv'
    captured = ranged.with_name('motion_capture_dynamic_exp_mid.csv')
    samples = lias.nearest(lias._samples(ranged, Counter()), 0.1)
    stamps = np.array([sample.stamp_ns for sample in samples])
    real = truth_at(track(1, lias._truth(captured, Counter()), lias.TRUTH_S), stamps).positions
    rows = [line.split(',') for line in captured.read_text().splitlines()[1:]]
    nearest = np.searchsorted([lias._stamp(row[0]) for row in rows], stamps)
    qx, qy = np.array([numbers(rows[k][5:7]) for k in nearest]).T
    return stamps, np.array([sample.ranges for sample in samples]), real, 2.0 * np.arctan2(qy, qx)


def rmse_of(nodes, d, real, stamps, unbiased=True):
    """Of plain least squares an epoch, after the slice; nodes (..., N, 3), d (K, N), a bias each from the slice."""
    early = stamps - stamps[0] < SLICE_NS
    if unbiased:
        d = d - np.nanmean((d - np.linalg.norm(real[:, None] - nodes, axis=-1))[early], axis=0)
    flat = np.sqrt(d**2 - (nodes[..., 2] - lias.HEIGHT) ** 2)
    e = (least_squares(nodes[..., :2], flat) - real[:, :2])[~early]
    return float(np.sqrt(np.mean(np.sum(e**2, axis=-1))))


def test_what_ranges_of_three_tags_are_worth_is_as_the_page_says(trolley):
    stamps, ranges, real, heading = trolley
    nodes, equal = np.array(lias.ANCHORS), np.full(3, 1.0 / 3.0)
    heading = heading + np.deg2rad(8.0)
    turned = np.stack([np.cos(heading), -np.sin(heading), np.sin(heading), np.cos(heading)], axis=-1).reshape(-1, 2, 2)
    levers = np.zeros((len(stamps), 3, 3))
    levers[..., :2] = np.array(lias.LEVERS) @ np.swapaxes(turned, -1, -2)
    each = (nodes[None, :, None] - levers[:, None]).reshape(len(stamps), 24, 3)  # where a node is from the centroid
    found = [
        rmse_of(nodes, ranges @ equal, real, stamps),
        rmse_of(nodes, ranges @ lias.weights(), real, stamps),
        rmse_of(each, ranges.reshape(-1, 24), real, stamps),
        rmse_of(nodes, ranges @ equal, real, stamps, unbiased=False),
    ]
    table = PAGE[PAGE.index('| ranges | RMSE') :].split('\n\n')[0]
    assert found == pytest.approx([float(x) for x in re.findall(r'\| ([\d.]+) m \|', table)], abs=0.0006)
    told = re.search(r'weights ([\d.]+), ([\d.]+) and ([\d.]+)', PAGE).groups()
    assert lias.weights() == pytest.approx(list(map(float, told)), abs=0.0006)


def test_columns_of_the_flat_are_rows_of_its_anchors(tmp_path):
    root = real_data('kolakowski_flat_ble')
    anchors = kolakowski.read_anchors(root / 'anchors.csv')
    windows = list(kolakowski._windows(root / 'calibration' / 'calibration_df.csv', anchors, Counter()))
    assert f'`calibration/calibration_df.csv` ({len(windows)}\nwindows' in PAGE
    squares, sigma = np.empty((2, 6, 6))
    for column, anchor in itertools.product(range(6), range(6)):
        place = np.array(list(anchors.values())[anchor])
        heard = np.array(
            [(w.x, w.y, kolakowski.HEIGHT, w.rssi_dbm[column + 1]) for w in windows if column + 1 in w.rssi_dbm]
        )
        d = np.linalg.norm(heard[:, :3] - place, axis=-1)
        fit = fit_path_loss(d, heard[:, 3])
        squares[column, anchor] = np.sum((heard[:, 3] - fit.p1_dbm + 10.0 * fit.n * np.log10(d)) ** 2)
        sigma[column, anchor] = fit.sigma_db
    costs = {order: sum(squares[range(6), order]) for order in itertools.permutations(range(6))}
    best = min(costs, key=costs.__getitem__)
    assert [k + 1 for k in range(6) if best[k] != k] == [4, 6]
    (share,) = re.findall(r'within ([\d.]+) % of the best \(4 and 6 exchanged\)', PAGE)
    assert 100.0 * (costs[tuple(range(6))] / costs[best] - 1.0) == pytest.approx(float(share), abs=0.006)
    ahead = [np.delete(sigma[k], k).min() - sigma[k, k] for k in range(6)]
    told = re.search(
        r'by ([\d.]+) and ([\d.]+) dB of scatter, 4 by ([\d.]+) dB; 5 is ([\d.]+) dB behind anchor 3, 1 and 6 are '
        r'([\d.]+) and ([\d.]+) dB\s+behind anchor 4',
        PAGE.replace('fit\ntheir', 'fit their'),
    ).groups()
    assert [ahead[1], ahead[2], ahead[3], -ahead[4], -ahead[0], -ahead[5]] == pytest.approx(
        [float(x) for x in told], abs=0.06
    )
