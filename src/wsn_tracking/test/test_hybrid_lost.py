"""Tracks that are silent, carried elsewhere or wrong are given up and found anew."""

import numpy as np
import pytest
from hybrid_cases import ANCHORS, ON_TRACK, RESTING, S, errors, misread, moved, recorded, tracked, walk_of

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig, RobustConfig, StartConfig


def test_a_feed_slower_than_stale_keeps_its_track_for_four_periods():
    """A range every 1.5 s, and a `stale` of 1 s as by default; then silence."""
    period = 1_500_000_000
    each = [walk_of([x], seed=k, each=4)[0] for k, x in enumerate(RESTING[:20])]
    epochs = [moved(epoch._replace(request_seq=k), k * period) for k, epoch in enumerate(each)]
    tracker, estimates = tracked(epochs, HybridConfig(period=1.5))
    assert {e.kind for e in estimates[1:]} == {Kind.LOCAL}
    kinds = [tracker.step(Epoch(1, 20 + k, (19 + k) * period + 1, ()))[0].kind for k in range(1, 5)]
    assert kinds == [Kind.LOCAL] * 3 + [Kind.START]


@pytest.mark.parametrize('kind', ['auto', 'ls'])
def test_a_silent_track_is_stale_after_a_second_and_found_anew_by_least_squares(kind):
    first = walk_of(RESTING[:60])
    later = [moved(e, e.stamp_ns + 3 * S) for e in walk_of(np.tile([3.2, 4.9], (60, 1)))]
    tracker = HybridTracker(HybridConfig(start=StartConfig(kind=kind)), ANCHORS, 1)
    for epoch in first:
        tracker.step(epoch)
    (silent,) = tracker.step(Epoch(1, 60, first[-1].stamp_ns + round(0.9 * S), ()))
    assert silent.kind == Kind.LOCAL
    (lost,) = tracker.step(Epoch(1, 61, first[-1].stamp_ns + round(1.1 * S), ()))
    assert (lost.kind, tracker.counters['stale'], tracker.state()['phase']) == (Kind.START, 1, 'lost')
    estimates = [tracker.step(epoch)[0] for epoch in later]
    assert tracker.counters['reacquired'] == 1
    assert [e.kind for e in estimates].index(Kind.LOCAL) <= 8
    assert errors(estimates, [3.2, 4.9])[-20:].max() < ON_TRACK


def test_a_target_that_was_carried_elsewhere_is_found_there():
    epochs = walk_of(np.concatenate([RESTING, np.tile([3.2, 4.9], (120, 1))]))
    for form in ('inflate', 'imm', 'ekf'):
        tracker, estimates = tracked(epochs, HybridConfig(form=form))
        assert tracker.counters['reacquired'] >= 1
        assert errors(estimates, [3.2, 4.9])[170:].max() < ON_TRACK  # 2.5 s later
    tracker, _ = tracked(epochs, HybridConfig(robust=RobustConfig(gate=0.0)))
    assert tracker.counters['gated'] == 0


@pytest.mark.parametrize('seed', [11, 12])
def test_when_two_targets_change_ids_each_track_goes_over_within_a_second(seed):
    """15 gated ranges are a share that no luck explains; then least squares finds the other one."""
    own = [recorded('d_phase', seed, target, lasts=14.0) for target in (1, 2)]
    renamed = [
        e._replace(target_id=1, measurements=tuple(p._replace(target_id=1) for p in e.measurements))
        for e in own[1][0][160:]
    ]
    tracker, estimates = tracked([*own[0][0][:160], *renamed])
    off = errors(estimates, np.concatenate([own[0][1][:160], own[1][1][160:]]))
    assert (tracker.counters['rejected'], tracker.counters['reacquired']) == (1, 1)
    assert off[20:160].max() < ON_TRACK
    assert off[180:].max() < ON_TRACK


def test_a_track_that_its_ranges_do_not_fit_is_given_up():
    """Ranges that are 0.11 m wrong, to and fro, pass the gate each by itself."""
    right = walk_of(RESTING)
    wrong = [misread(e, lambda z, off=0.11 * (-1) ** k: z + off) for k, e in enumerate(right)]
    quiet, _ = tracked(right)
    tracker, _ = tracked([*right[:60], *wrong[60:]], HybridConfig(form='ekf'))
    assert quiet.counters['misfit'] == 0
    assert tracker.counters['misfit'] >= 1
    never, _ = tracked([*right[:60], *wrong[60:]], HybridConfig(form='ekf', robust=RobustConfig(misfit=0.0)))
    assert never.counters['misfit'] == 0
