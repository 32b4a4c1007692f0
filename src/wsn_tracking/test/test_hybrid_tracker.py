"""System D's tracker: one track a target, whatever it hears."""

import random
from dataclasses import replace

import numpy as np
import pytest
from hybrid_cases import ANCHORS, PERIOD_NS, S, epoch_of, errors, recorded, tracked, walk_of

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.radio import rssi_at
from wsn_tracking.parameters import build
from wsn_tracking.sensing.values import Epoch, Modality, Range, RangeBearing, Rssi
from wsn_tracking.trackers.estimate import Kind, check_usable
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, RobustConfig, StartConfig

LINE = np.column_stack([1.0 + 0.01 * np.arange(160), np.full(160, 1.3)])
RESTING = np.tile([1.3, 2.6], (120, 1))


def test_two_interleaved_targets_are_two_separate_runs_to_the_last_bit():
    separate, together = {}, {1: [], 2: []}
    own = {target: recorded('d_phase', target=target, lasts=6.0)[0] for target in (1, 2)}
    for target, epochs in own.items():
        separate[target] = tracked(epochs, target=target)[1]
    trackers = {target: HybridTracker(HybridConfig(), ANCHORS, target) for target in own}
    for pair in zip(own[1], own[2], strict=True):
        for epoch in pair:
            together[epoch.target_id] += trackers[epoch.target_id].step(epoch)
    assert differences(separate[1], together[1]) == []
    assert differences(separate[2], together[2]) == []


def test_before_the_start_the_target_may_be_anywhere_in_the_area():
    tracker = HybridTracker(HybridConfig(area=(0.0, 0.0, 4.0, 6.0)), ANCHORS, 7)
    (first,) = tracker.step(epoch_of(0, [], target=7))
    assert (first.kind, first.source, first.measurements) == (Kind.START, 'hybrid_target_7', ())
    assert tracker.outputs == ('hybrid_target_7',)
    np.testing.assert_allclose(first.mean, [2.0, 3.0, 0.0, 0.0])
    np.testing.assert_allclose(np.diag(first.covariance)[:2], [16.0 / 12.0, 36.0 / 12.0])
    assert tracker.state()['phase'] == 'starting'
    (ring,) = tracker.step(epoch_of(1, [(0, 3.0)], target=7))
    assert ring.kind == Kind.START
    assert ring.measurements == (1,)
    assert 0.5 < np.sqrt(ring.covariance[0, 0]) < 3.0


def test_a_track_starts_by_least_squares_and_is_consistent():
    truth_of, found, kinds = [], [], []
    for seed in range(6):
        epochs, truth = recorded('d_stop', seed, rest=0.5)
        tracker, estimates = tracked(epochs)
        assert tracker.counters['started'] == 1
        kinds.append([e.kind for e in estimates])
        truth_of.append(truth[40:])
        found.append(estimates[40:])
    assert {k for run in kinds for k in run[40:]} == {Kind.LOCAL}
    assert max(run.index(Kind.LOCAL) for run in kinds) <= 8
    e = np.array(
        [[est.mean[:2] - x for est, x in zip(*pair, strict=True)] for pair in zip(found, truth_of, strict=True)]
    )
    P = np.array([[est.covariance[:2, :2] for est in run] for run in found])
    assert 1.3 < np.mean(nees(e, P)) < 3.0  # 2; the design's q_w is about right for a straight walk
    for run in found:
        check_usable(run[-1])


@pytest.mark.parametrize('form', ['inflate', 'decay', 'imm', 'ekf'])
def test_every_form_tracks(form):
    epochs, truth = recorded('d_arc_stop', 3)
    tracker, estimates = tracked(epochs, HybridConfig(form=form))
    assert np.sqrt(np.mean(errors(estimates, truth)[40:] ** 2)) < 0.05
    assert tracker.counters['gated'] == 0


def test_an_epoch_of_several_ranges_is_as_many_epochs_of_one_in_the_order_of_their_stamps():
    singles = walk_of(LINE)
    groups = []
    for k in range(0, 160, 4):
        packets = [p for e in singles[k : k + 4] for p in e.measurements]
        random.Random(k).shuffle(packets)
        groups.append(Epoch(1, k + 3, singles[k + 3].stamp_ns, tuple(packets)))
    _, one_by_one = tracked(singles)
    _, together = tracked(groups)
    for one, several in zip(one_by_one[3::4], together, strict=True):  # seconds are counted from the first epoch
        np.testing.assert_allclose(several.mean, one.mean, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(several.covariance, one.covariance, rtol=0.0, atol=1e-9)
        assert several.kind == one.kind
    assert together[5].measurements == tuple(sorted(together[5].measurements))


def test_an_empty_epoch_predicts():
    _, estimates = tracked([*walk_of(LINE), *(epoch_of(k, []) for k in range(160, 170))])
    before, after = estimates[159], estimates[169]
    F = np.eye(4) + 0.5 * np.eye(4, k=2)
    np.testing.assert_allclose(after.mean, F @ before.mean, atol=1e-9)
    assert after.covariance[0, 0] > before.covariance[0, 0]
    assert after.measurements == ()
    assert after.kind == Kind.LOCAL


def test_an_estimate_is_of_the_stamp_of_its_epoch_even_where_ranges_came_later():
    epochs = walk_of(LINE, noise=0.0)
    late = [e._replace(stamp_ns=e.stamp_ns - 30_000_000) for e in epochs]
    _, estimates = tracked(late)
    x = np.array([e.mean[0] for e in estimates[80:]])
    np.testing.assert_allclose(x, LINE[80:, 0] - 0.2 * 0.03, atol=0.004)


# --- what does not belong to the track


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


# --- tracks that are lost


def test_a_feed_slower_than_stale_keeps_its_track_for_four_periods():
    """A range every 1.5 s, and a `stale` of 1 s as by default; then silence."""
    period = 1_500_000_000
    walk = [walk_of([x], seed=k, each=4)[0].measurements for k, x in enumerate(RESTING[:20])]
    epochs = [
        Epoch(1, k, k * period, tuple(p._replace(stamp_ns=k * period) for p in ranges)) for k, ranges in enumerate(walk)
    ]
    tracker, estimates = tracked(epochs, HybridConfig(period=1.5))
    assert {e.kind for e in estimates[1:]} == {Kind.LOCAL}
    kinds = [tracker.step(Epoch(1, 20 + k, (19 + k) * period + 1, ()))[0].kind for k in range(1, 5)]
    assert kinds == [Kind.LOCAL] * 3 + [Kind.START]


@pytest.mark.parametrize('kind', ['auto', 'ls'])
def test_a_silent_track_is_stale_after_a_second_and_found_anew_by_least_squares(kind):
    first = walk_of(RESTING[:60])
    later = [e._replace(stamp_ns=e.stamp_ns + 3 * S) for e in walk_of(np.tile([3.2, 4.9], (60, 1)))]
    later = [e._replace(measurements=tuple(p._replace(stamp_ns=e.stamp_ns) for p in e.measurements)) for e in later]
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
    assert errors(estimates, [3.2, 4.9])[-20:].max() < 0.1


def test_a_target_that_was_carried_elsewhere_is_found_there():
    epochs = walk_of(np.concatenate([RESTING, np.tile([3.2, 4.9], (120, 1))]))
    for form in ('inflate', 'imm', 'ekf'):
        tracker, estimates = tracked(epochs, HybridConfig(form=form))
        assert tracker.counters['reacquired'] >= 1
        assert errors(estimates, [3.2, 4.9])[170:].max() < 0.12  # 2.5 s later
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
    assert off[20:160].max() < 0.15
    assert off[180:].max() < 0.15


def test_a_track_that_its_ranges_do_not_fit_is_given_up():
    """Ranges that are 0.15 m wrong, to and fro, pass the gate each by itself."""
    right = walk_of(RESTING)
    wrong = [
        e._replace(measurements=tuple(p._replace(range=p.range + 0.11 * (-1) ** k) for p in e.measurements))
        for k, e in enumerate(walk_of(RESTING))
    ]
    quiet, _ = tracked(right)
    tracker, _ = tracked([*right[:60], *wrong[60:]], HybridConfig(form='ekf'))
    assert quiet.counters['misfit'] == 0
    assert tracker.counters['misfit'] >= 1
    never, _ = tracked([*right[:60], *wrong[60:]], HybridConfig(form='ekf', robust=RobustConfig(misfit=0.0)))
    assert never.counters['misfit'] == 0


def test_a_reset_tracker_is_a_new_one():
    epochs, _ = recorded('d_stop', 5, rest=0.5)
    tracker, first = tracked(epochs)
    tracker.reset()
    assert differences(first, [tracker.step(epoch)[0] for epoch in epochs]) == []


# --- where least squares is not possible


def test_a_target_that_two_nodes_hear_is_one_of_two_places():
    """The other side of the line through the nodes lies outside the area, or else both are told."""
    two = make_anchors([1, 2], [[0.0, 0.0], [4.0, 0.0]])
    places = np.column_stack([1.0 + 0.002 * np.arange(200), np.full(200, 1.5)])
    half, both = (0.0, 0.0, 4.0, 3.0), (0.0, -3.0, 4.0, 3.0)
    epochs = walk_of(places, anchors=two)
    tracker, estimates = tracked(epochs, HybridConfig(area=half), two)
    assert tracker.counters['started'] == 1
    assert errors(estimates, places)[60:].max() < 0.1
    torn, estimates = tracked(epochs, HybridConfig(area=both), two)
    assert {e.kind for e in estimates} == {Kind.START}
    assert torn.state()['hypotheses'] == 2
    assert abs(estimates[-1].mean[1]) < 1.0
    assert np.sqrt(estimates[-1].covariance[1, 1]) == pytest.approx(1.5, rel=0.2)


def test_hypotheses_alone_find_a_target_from_single_ranges_at_long_intervals():
    slow = [
        e._replace(stamp_ns=k * S, measurements=tuple(p._replace(stamp_ns=k * S) for p in e.measurements))
        for k, e in enumerate(walk_of(np.tile([1.3, 2.6], (40, 1)), noise=0.05))
    ]
    config = HybridConfig(
        range_std=0.1,
        stale=5.0,
        motion=MotionConfig(1e-4, 20.0),
        start=StartConfig(kind='hypotheses', velocity_std=0.05),
    )
    tracker, estimates = tracked(slow, config)
    assert tracker.counters['started'] == 1
    assert errors(estimates, [1.3, 2.6])[15:].max() < 0.2
    # silent, then somewhere near: what was known before is not forgotten
    later = [e._replace(stamp_ns=e.stamp_ns + 80 * S) for e in slow]
    later = [e._replace(measurements=tuple(p._replace(stamp_ns=e.stamp_ns) for p in e.measurements)) for e in later]
    back = [tracker.step(e)[0] for e in later]
    assert tracker.counters['stale'] == tracker.counters['reacquired'] == 1
    assert errors(back, [1.3, 2.6])[15:].max() < 0.2


# --- radios


def test_distances_are_three_dimensional_and_radios_are_calibrated():
    high = ANCHORS.positions + np.array([0.0, 0.0, 2.0])
    crooked = make_anchors(ANCHORS.ids, high, bias=0.3, scale=1.05)
    straight = walk_of(LINE, anchors=make_anchors(ANCHORS.ids, high), z=0.5)
    measured = [
        e._replace(measurements=tuple(p._replace(range=1.05 * p.range + 0.3) for p in e.measurements)) for e in straight
    ]
    _, estimates = tracked(measured, HybridConfig(target_height=0.5), crooked)
    assert errors(estimates, LINE)[40:].max() < 0.12
    _, flat = tracked(measured, HybridConfig(target_height=2.0, robust=RobustConfig(gate=0.0)), crooked)
    assert errors(flat, LINE)[40:].max() > 0.15


@pytest.mark.parametrize('told', ['rssi', 'rssi_sigma', 'range', 'range_variance'])
def test_signal_strengths_become_ranges_whose_error_grows_with_them(told):
    """Twelve nodes at 1 Hz, 1.56 dB: position errors of some 0.12 d over the root of the nodes."""
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
    assert np.sqrt(np.mean(errors(estimates, [1.3, 2.6])[10:] ** 2)) < 0.25


# --- the document's form


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
    assert errors(survived, truth)[70:80].max() < 0.1


def test_the_literal_form_gates_and_predicts_too():
    epochs = walk_of(LINE, each=6)
    bad = epochs[100]._replace(
        measurements=(epochs[100].measurements[0]._replace(range=9.0), *epochs[100].measurements[1:])
    )
    tracker, estimates = tracked([*epochs[:100], bad, epoch_of(101, []), epoch_of(101, [])], literal())
    assert tracker.counters['gated'] == 1
    assert len(estimates[100].measurements) == 5
    assert errors(estimates[100:101], LINE[100:101])[0] < 0.05
    lost, _ = tracked([*epochs[:100], *(replace_all(e, 9.0) for e in epochs[100:150])], literal())
    assert lost.counters['stale'] + lost.counters['rejected'] >= 1


def replace_all(epoch, z):
    return epoch._replace(measurements=tuple(p._replace(range=z) for p in epoch.measurements))


# --- parameters


@pytest.mark.parametrize(
    ('values', 'said'),
    [
        ({'form': 'magic'}, 'expected one of inflate, decay, literal, imm, ekf'),
        ({'motion.spectral_density': 0.0}, 'without process noise a filter stops listening'),
        ({'form': 'imm', 'models.calm': 50.0}, 'expected 0 < calm < brisk'),
        ({'area': [1.0, 2.0, 3.0]}, 'area'),
    ],
)
def test_parameters_that_contradict_each_other_are_refused(values, said):
    with pytest.raises(TrackingError, match=said):
        build(HybridConfig, values).checked()


def test_a_calibration_of_other_nodes_is_refused(tmp_path):
    with pytest.raises(TrackingError):
        HybridTracker(replace(HybridConfig(), channel=str(tmp_path / 'none.yaml')), ANCHORS, 1)


def test_stamps_count_not_numbers():
    """The same ranges an hour later are the same track."""
    epochs = walk_of(LINE)
    moved = [
        e._replace(stamp_ns=e.stamp_ns + 3600 * S, measurements=tuple(
            p._replace(stamp_ns=p.stamp_ns + 3600 * S) for p in e.measurements))
        for e in epochs
    ]  # fmt: skip
    first, second = tracked(epochs)[1], tracked(moved)[1]
    assert differences(first, [e._replace(stamp_ns=e.stamp_ns - 3600 * S) for e in second]) == []
    assert epochs[1].stamp_ns == PERIOD_NS
