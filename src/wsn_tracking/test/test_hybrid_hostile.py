"""System D fed with nonsense: estimates stay finite, covariances definite, and nothing is raised."""

from __future__ import annotations

import math
import random
import warnings

import numpy as np
import pytest

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.simulation.d_cells import nodes
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, RobustConfig, StartConfig

NAN, INF, MS, S = math.nan, math.inf, 1_000_000, 1_000_000_000
FIELDS = {
    'cells': nodes(),
    'one_node': make_anchors([1], [[0.0, 0.0, 0.0]]),
    'two_nodes': make_anchors([1, 2], [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]),
    'on_a_line': make_anchors([1, 2, 3, 4], [[float(x), 0.0, 0.0] for x in range(4)]),
    'at_one_place': make_anchors([1, 2, 3], [[1.0, 1.0, 1.0]] * 3),
    'far_from_the_origin': make_anchors(
        [1, 2, 3, 4], [[5e5 + x, 5e5 + y, 0.0] for x in (0.0, 3.0) for y in (0.0, 3.0)]
    ),
}
RANGES = (0.0, 1e-300, 1e-3, 1.0, 2.0, 3.0, 1e4, 1e308, -1.0, NAN, INF)
VARIANCES = (NAN, 0.0, 1e-300, 4e-4, 1e4, INF, -1.0)
DBM = (-40.0, -127.0, 20.0, -80.0, NAN, INF)
STEPS = (0, 1, 50 * MS, 50 * MS, S, 1000 * S, -50 * MS, -10 * S, 100_000_000 * S)


def config_of(draw):
    return HybridConfig(
        form=draw.choice(['inflate', 'decay', 'imm', 'ekf']),
        target_height=draw.choice([0.0, 5.0]),
        start=StartConfig(kind=draw.choice(['auto', 'ls', 'hypotheses'])),
        robust=RobustConfig(gate=draw.choice([0.0, 6.0]), dof=draw.choice([0.0, 4.0])),
        motion=MotionConfig(draw.choice([1e-6, 0.01, 100.0]), draw.choice([0.0, 5.0])),
    )


def packet_of(draw, ids, k, stamp):
    node, stamp = draw.choice([*ids, 99]), stamp + draw.choice([0, 0, 0, -10 * MS, 10 * MS, 10**9 * S, -(10**9) * S])
    kind = draw.randrange(3)
    if kind == 0:
        return Range(stamp, node, 1, k, k, int(Modality.ULTRASOUND), draw.choice(RANGES), draw.choice(VARIANCES))
    if kind == 1:
        return Rssi(stamp, node, 1, k, k, draw.choice(DBM), draw.choice([NAN, 0.0, 4.0, 1e9]))
    return RangeBearing(stamp, node, draw.choice([1, 2]), k, k, draw.choice(RANGES), 0.1, (NAN, 0.0, 0.0, 1.0))


@pytest.mark.parametrize('field', FIELDS)
def test_nonsense_leaves_finite_estimates_with_definite_covariances(field):
    anchors = FIELDS[field]
    for seed in range(6):
        draw = random.Random(f'{field} {seed}')
        tracker, stamp = HybridTracker(config_of(draw), anchors, 1), 0
        for k in range(40):
            stamp += draw.choice(STEPS)
            packets = [packet_of(draw, anchors.ids.tolist(), k, stamp) for _ in range(draw.choice([0, 1, 1, 1, 3, 8]))]
            with warnings.catch_warnings():
                warnings.simplefilter('error')
                (estimate,) = tracker.step(Epoch(1, k, stamp, tuple(packets)))
            P = estimate.covariance
            assert np.all(np.isfinite(estimate.mean))
            assert np.all(np.isfinite(P))
            assert np.linalg.eigvalsh(P)[0] > -1e-6 * np.abs(P).max()  # beside 1e4, a variance of 1e-6 is rounding
            tracker.state()
