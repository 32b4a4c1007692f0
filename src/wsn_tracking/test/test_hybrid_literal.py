"""The document's form of system D, for ranges of one instant."""

import numpy as np
import pytest
from hybrid_cases import LINE, ON_TRACK, epoch_of, errors, misread, tracked, walk_of

from wsn_tracking.errors import TrackingError
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, RobustConfig


def literal(**more):
    return HybridConfig(form='literal', motion=MotionConfig(1e-3), **more)


def test_the_literal_form_is_refused_where_ranges_come_one_by_one():
    with pytest.raises(
        TrackingError, match=r'literal takes ranges of 3 nodes or more at one instant.*set `form` to inflate'
    ):
        tracked(walk_of(LINE), literal())
    spread = walk_of(LINE, each=4)[0]
    spread = spread._replace(
        measurements=tuple(p._replace(stamp_ns=i * 1000) for i, p in enumerate(spread.measurements))
    )
    with pytest.raises(TrackingError, match='come one by one'):
        tracked([spread], literal())


def test_the_literal_form_tracks_and_answers_a_stop_with_simultaneous_ranges():
    truth = np.concatenate([LINE[:1] + [[0.025 * k, 0.0] for k in range(80)], np.tile(LINE[0] + [1.975, 0.0], (60, 1))])
    epochs = walk_of(truth, each=12)
    tracker, estimates = tracked(epochs, literal())
    plain, slow = tracked(epochs, HybridConfig(form='ekf', motion=MotionConfig(1e-3), robust=RobustConfig(gate=0.0)))
    assert tracker.counters['manoeuvre'] >= 1
    assert plain.counters['manoeuvre'] == 0
    after = slice(82, 110)
    assert np.mean(errors(estimates, truth)[after] ** 2) < 0.7 * np.mean(errors(slow, truth)[after] ** 2)
    thin = [e._replace(measurements=e.measurements[: 2 if 40 < k < 60 else 12]) for k, e in enumerate(epochs)]
    _, survived = tracked(thin, literal())  # whoever had simultaneous ranges may lose some
    assert errors(survived, truth)[70:80].max() < ON_TRACK


def test_the_literal_form_gates_and_predicts_too():
    epochs = walk_of(LINE, each=6)
    bad = epochs[100]._replace(
        measurements=(epochs[100].measurements[0]._replace(range=9.0), *epochs[100].measurements[1:])
    )
    tracker, estimates = tracked([*epochs[:100], bad, epoch_of(101, []), epoch_of(101, [])], literal())
    assert tracker.counters['gated'] == 1
    assert len(estimates[100].measurements) == 5
    assert errors(estimates[100:101], LINE[100:101])[0] < ON_TRACK
    lost, _ = tracked([*epochs[:100], *(misread(e, lambda _: 9.0) for e in epochs[100:150])], literal())
    assert lost.counters['stale'] + lost.counters['rejected'] >= 1
