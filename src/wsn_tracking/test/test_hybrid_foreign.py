"""What does not belong to a track is gated, counted, and does not disturb it."""

import numpy as np
import pytest
from hybrid_cases import ANCHORS, LINE, S, epoch_of, errors, recorded, tracked, walk_of

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import Modality, Range, RangeBearing, Rssi
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig


def test_ranges_of_another_target_under_this_id_are_gated_and_counted_and_do_not_disturb_the_track():
    for seed in range(2):
        epochs, truth = recorded('d_stop', seed)
        other, _ = recorded('d_phase', seed + 100, target=1)
        mixed = [
            e._replace(measurements=tuple(sorted((*e.measurements, *o.measurements), key=lambda p: p.node_id)))
            if k >= 20 and k % 5 == 0 else e
            for k, (e, o) in enumerate(zip(epochs, [o_._replace(target_id=1) for o_ in other], strict=False))
        ]  # fmt: skip
        wrong = sum(k >= 20 and k % 5 == 0 for k in range(len(mixed)))
        tracker, estimates = tracked(mixed)
        _, clean = tracked(epochs)
        assert 0.8 * wrong <= tracker.counters['gated'] <= wrong  # a few are as long as the right ones
        assert tracker.counters['rejected'] == tracker.counters['stale'] == tracker.counters['reacquired'] == 0
        rmse = [np.sqrt(np.mean(errors(e, truth)[20:] ** 2)) for e in (estimates, clean)]
        assert rmse[0] < 1.6 * rmse[1] + 0.01


def test_what_cannot_be_used_is_counted_and_changes_nothing():
    epochs = walk_of(LINE)
    stamp = epochs[100].stamp_ns
    junk = (
        Range(stamp, 99, 1, 0, 100, Modality.ULTRASOUND, 1.0),
        Range(stamp, 1, 2, 0, 100, Modality.ULTRASOUND, 1.0),
        Range(stamp, 1, 1, 0, 100, Modality.ULTRASOUND, -1.0),
        Range(stamp, 2, 1, 0, 100, Modality.ULTRASOUND, float('nan')),
        Rssi(stamp, 3, 1, 0, 100, float('nan')),
        Range(stamp - 2 * S, 4, 1, 0, 100, Modality.ULTRASOUND, 1.0),
    )
    dirty = [*epochs[:100], epochs[100]._replace(measurements=(*epochs[100].measurements, *junk)), *epochs[101:]]
    tracker, estimates = tracked(dirty)
    assert differences(estimates, tracked(epochs)[1]) == []
    counted = {k: tracker.counters[k] for k in ('unknown_node', 'other_target', 'unusable', 'late')}
    assert counted == {'unknown_node': 1, 'other_target': 1, 'unusable': 3, 'late': 1}


def test_of_range_and_bearing_the_range_counts():
    """What did not arrive is lost, not wrong."""
    ranges = walk_of(LINE, each=2)
    covariance = (0.02**2, 0.0, 0.0, 0.25)
    seen = [
        e._replace(
            measurements=tuple(
                RangeBearing(*p[:5], p.range, 0.3, covariance, arrived=p.node_id != 7) for p in e.measurements
            )
        )
        for e in ranges
    ]
    without = [e._replace(measurements=tuple(p for p in e.measurements if p.node_id != 7)) for e in ranges]
    tracker, estimates = tracked(seen)
    assert differences(estimates, tracked(without)[1]) == []
    assert not [name for name in ('unusable', 'gated', 'late') if tracker.counters[name]]


def test_an_epoch_of_another_target_is_refused():
    with pytest.raises(TrackingError, match='target 2 was given to the tracker of target 1'):
        HybridTracker(HybridConfig(), ANCHORS, 1).step(epoch_of(0, [], target=2))
