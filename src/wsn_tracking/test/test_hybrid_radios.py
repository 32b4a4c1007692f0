"""Radios of system D: in three dimensions, calibrated, and signal strengths in the place of ranges."""

from dataclasses import replace

import numpy as np
import pytest
from hybrid_cases import ANCHORS, LINE, ON_TRACK, S, errors, misread, tracked, walk_of

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, RobustConfig, StartConfig


def test_distances_are_three_dimensional_and_radios_are_calibrated():
    high = ANCHORS.positions + np.array([0.0, 0.0, 2.0])
    crooked = make_anchors(ANCHORS.ids, high, bias=0.3, scale=1.05)
    straight = walk_of(LINE, anchors=make_anchors(ANCHORS.ids, high), z=0.5)
    measured = [misread(e, lambda z: 1.05 * z + 0.3) for e in straight]
    _, estimates = tracked(measured, HybridConfig(target_height=0.5), crooked)
    assert errors(estimates, LINE)[40:].max() < ON_TRACK
    _, flat = tracked(measured, HybridConfig(target_height=2.0, robust=RobustConfig(gate=0.0)), crooked)
    assert errors(flat, LINE)[40:].max() > 10.0 * ON_TRACK


@pytest.mark.parametrize('told', ['rssi', 'rssi_sigma', 'range', 'range_variance'])
def test_signal_strengths_become_ranges_whose_error_grows_with_them(told):
    """Twelve nodes at 1 Hz, 1.56 dB: in each of two dimensions 0.12 x 3 m over the root of six, 0.2 m in all."""
    rng = np.random.default_rng(4)
    anchors = ANCHORS
    epochs = []
    for k in range(60):
        d = np.linalg.norm([1.3, 2.6, 0.0] - anchors.positions, axis=-1)
        dbm = rssi_at(anchors, d) + 1.56 * rng.standard_normal(12)
        z = 10.0 ** ((-45.0 - dbm) / 30.0)
        packets = []
        for row, node in enumerate(anchors.ids.tolist()):
            if told.startswith('rssi'):
                sigma = 1.56 if told == 'rssi_sigma' else float('nan')
                packets.append(Rssi(k * S, node, 1, k, k, float(dbm[row]), sigma))
            else:
                variance = float((0.1197 * z[row]) ** 2) if told == 'range_variance' else float('nan')
                packets.append(Range(k * S, node, 1, k, k, Modality.RSSI, float(z[row]), variance))
        epochs.append(Epoch(1, k, k * S, tuple(packets)))
    config = HybridConfig(
        period=1.0, stale=5.0, motion=MotionConfig(1e-3), start=StartConfig(window=3.0, velocity_std=0.1)
    )
    tracker, estimates = tracked(epochs, config)
    assert tracker.counters['started'] == 1
    assert np.sqrt(np.mean(errors(estimates, [1.3, 2.6])[10:] ** 2)) < 0.2


def test_a_range_without_a_stamp_is_of_its_epoch():
    """Of a driver that leaves headers empty: not of the year 1970."""
    stamped = [e._replace(stamp_ns=e.stamp_ns + 1_700_000_000 * S) for e in walk_of(LINE)]
    stamped = [e._replace(measurements=tuple(p._replace(stamp_ns=e.stamp_ns) for p in e.measurements)) for e in stamped]
    bare = [e._replace(measurements=tuple(p._replace(stamp_ns=0) for p in e.measurements)) for e in stamped]
    (_, told), (_, same) = tracked(stamped), tracked(bare)
    np.testing.assert_array_equal([e.mean for e in told], [e.mean for e in same])
    assert errors(same, LINE)[40:].max() < ON_TRACK


def test_a_calibration_of_other_nodes_is_refused(tmp_path):
    with pytest.raises(TrackingError):
        HybridTracker(replace(HybridConfig(), channel=str(tmp_path / 'none.yaml')), ANCHORS, 1)
