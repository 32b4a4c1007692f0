import math
from itertools import pairwise

import numpy as np
import pytest
from evaluation_cases import SECOND, T0, a_summary, estimate, line_truth, noisy_track, track
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.consistency import nees_interval
from wsn_tracking.evaluation.interpolation import Verdict, truth_at
from wsn_tracking.evaluation.score import match, pool, score
from wsn_tracking.evaluation.summary import Traffic, pool_summaries, traffic
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.sensing.values import Reason, TriggerReport
from wsn_tracking.trackers.estimate import Kind

EYE = np.eye(2)


def test_truth_at_a_recorded_stamp_is_the_recorded_position():
    truth = line_truth()
    at = truth_at(truth, truth.stamps_ns)
    np.testing.assert_array_equal(at.positions, truth.positions)
    assert np.all(at.verdicts == Verdict.SCORED)


@given(st.integers(0, 29 * SECOND))
def test_truth_between_stamps_is_on_the_line(after_ns):
    at = truth_at(line_truth(), np.array([T0 + after_ns]))
    expected = np.array([2.0, 1.0]) + after_ns * 1e-9 * np.array([1.0, 0.5])
    np.testing.assert_allclose(at.positions[0, :2], expected, rtol=0, atol=1e-9)


def test_one_nanosecond_is_not_lost_in_a_stamp_of_today():
    # A double of seconds since 1970 has steps of 240 ns.
    truth = Truth(1, np.array([T0, T0 + 4]), np.array([[0.0, 0, 0], [4.0, 0, 0]]), np.zeros((2, 3)))
    at = truth_at(truth, T0 + np.arange(5))
    np.testing.assert_array_equal(at.positions[:, 0], [0.0, 1.0, 2.0, 3.0, 4.0])


def test_truth_is_unknown_outside_and_within_a_long_gap_but_not_at_its_ends():
    truth = line_truth(4)
    positions, stamps = truth.positions[[0, 1, 3]], truth.stamps_ns[[0, 1, 3]]
    holed = truth._replace(positions=positions, stamps_ns=stamps)
    asked = T0 + np.array([-1, 0, SECOND, 2 * SECOND, 3 * SECOND, 3 * SECOND + 1])
    verdicts = truth_at(holed, asked, gap_s=1.5).verdicts
    names = [Verdict(v).name for v in verdicts]
    assert names == ['OUTSIDE_TRUTH', 'SCORED', 'SCORED', 'TRUTH_GAP', 'SCORED', 'OUTSIDE_TRUTH']
    assert np.all(truth_at(holed, asked, gap_s=2.0).verdicts[1:5] == Verdict.SCORED)


def test_nan_rows_of_the_truth_count_as_not_recorded():
    truth = line_truth(6)
    truth.positions[2:5] = np.nan
    verdicts = truth_at(truth, truth.stamps_ns).verdicts
    np.testing.assert_array_equal(verdicts, [0, 0, *[Verdict.TRUTH_GAP] * 3, 0])
    truth.positions[:] = np.nan
    assert np.all(truth_at(truth, truth.stamps_ns).verdicts == Verdict.OUTSIDE_TRUTH)


def test_hand_computed_score():
    truth = line_truth(4)
    errors = np.array([[3.0, -4.0], [0.0, 0.0], [-1.0, 0.0], [0.0, 2.0]])
    result = score(track(truth, errors, 2.0 * EYE), truth, skip_s=0.0)
    assert result.rmse_m == pytest.approx(math.sqrt(30 / 4))
    assert result.median_m == pytest.approx(1.5)
    assert result.ei_m == pytest.approx(2.5)
    assert result.esi_m == pytest.approx((4.0, 6.0))
    np.testing.assert_allclose(result.esi_series[1], [3.0, 4.0], atol=1e-12)
    assert result.nees == pytest.approx(30 / 2 / 4)
    assert result.epochs == result.nees_epochs == 4
    assert (result.first_ns, result.last_ns) == (T0, T0 + 3 * SECOND)
    assert result.nees_interval_independent == nees_interval(4)
    assert result.runs == 1


def test_a_consistent_filter_is_accepted_as_often_as_promised():
    truth, rng, accepted = line_truth(60), np.random.default_rng(11), 0
    covariance = np.array([[0.04, 0.03], [0.03, 0.09]])
    for _ in range(150):
        errors = rng.standard_normal((60, 2)) @ np.linalg.cholesky(covariance).T
        low, high = (result := score(track(truth, errors, covariance), truth, skip_s=0.0)).nees_interval
        accepted += low <= result.nees <= high
    assert accepted / 150 == pytest.approx(0.95, abs=0.05)


def test_skip_counts_from_the_first_epoch_of_the_recording():
    truth, estimates = noisy_track()
    assert score(estimates, truth).first_ns == T0 + 5 * SECOND
    late = estimates[3:]
    assert score(late, truth).first_ns == T0 + 8 * SECOND
    assert score(late, truth, start_ns=T0).first_ns == T0 + 5 * SECOND
    assert score(late, truth, start_ns=T0).unscored['skipped'] == 2
    assert score(late, truth, skip_s=0.0).unscored['skipped'] == 0


def test_skipping_everything_scores_nothing():
    truth, estimates = noisy_track()
    result = score(estimates, truth, skip_s=math.inf)
    assert result.epochs == 0
    assert result.unscored['skipped'] == len(estimates)


@pytest.mark.parametrize('skip_s', [-1.0, math.nan])
def test_an_impossible_skip_is_refused(skip_s):
    with pytest.raises(TrackingError, match='skip'):
        score([], line_truth(), skip_s)


@pytest.mark.parametrize('rows', [0, 30])
def test_no_estimate_or_no_truth_gives_nan_and_not_an_error(rows):
    truth = line_truth(rows)
    estimates = [] if rows else [estimate(T0, (1.0, 1.0), EYE)]
    result = score(estimates, truth, skip_s=0.0)
    assert result.epochs == 0
    lengths = (result.rmse_m, result.median_m, result.p95_m, result.ei_m, *result.esi_m, result.nees)
    assert all(math.isnan(value) for value in (*lengths, *result.nees_interval))
    assert sum(result.unscored.values()) == len(estimates)


def test_every_estimate_is_scored_or_counted_by_its_reason():
    truth = line_truth(30)
    keep = np.ones(30, dtype=bool)
    keep[15:20] = False
    holed = truth._replace(stamps_ns=truth.stamps_ns[keep], positions=truth.positions[keep])
    estimates = track(truth, np.zeros((30, 2)), EYE)
    estimates.append(estimate(T0 + 40 * SECOND, (0.0, 0.0), EYE))
    estimates[25] = estimates[25]._replace(mean=np.array([np.inf, 0.0, 0.0, 0.0]))
    result = score(estimates, holed)
    assert result.unscored == {'skipped': 5, 'not_finite': 1, 'outside_truth': 1, 'truth_gap': 5}
    assert result.epochs + sum(result.unscored.values()) == len(estimates)
    assert score(estimates, holed, gap_s=10.0).unscored['truth_gap'] == 0


def test_start_estimates_are_scored_like_the_rest():
    truth = line_truth()
    usual, started = (
        track(truth, np.full((30, 2), 0.1), EYE, kind=kind) for kind in (Kind.LOCAL, Kind.START)
    )
    assert score(usual, truth).rmse_m == score(started, truth).rmse_m


def test_unknown_and_singular_covariances_are_counted_apart():
    truth = line_truth(10)
    estimates = track(truth, np.full((10, 2), 1.0), EYE)
    estimates[0] = estimate(T0, (3.0, 2.0), None)
    estimates[1] = estimate(T0 + SECOND, (4.0, 2.5), np.zeros((2, 2)))
    result = score(estimates, truth, skip_s=0.0)
    assert result.without_nees == {'covariance_unknown': 1, 'covariance_singular': 1}
    assert result.nees == pytest.approx(2.0)
    assert (result.epochs, result.nees_epochs) == (10, 8)


def test_an_output_without_covariance_has_errors_but_no_nees():
    truth = line_truth()
    result = score(track(truth, np.full((30, 2), 0.1)), truth)
    assert result.rmse_m == pytest.approx(0.1 * math.sqrt(2.0))
    assert math.isnan(result.nees)
    assert all(math.isnan(bound) for bound in result.nees_interval)


def test_the_order_of_the_estimates_does_not_matter():
    truth, estimates = noisy_track()
    shuffled = [estimates[i] for i in np.random.default_rng(0).permutation(len(estimates))]
    assert score(shuffled, truth)[:10] == score(estimates, truth)[:10]


def test_another_target_is_refused():
    with pytest.raises(TrackingError, match='target 7, its truth is of target 8'):
        match(track(line_truth(), np.zeros((30, 2))), line_truth(target_id=8))


def test_states_in_another_order_are_refused():
    swapped = [estimate(T0, (0.0, 0.0), EYE, state_names=('x', 'vx', 'y', 'vy'))]
    with pytest.raises(TrackingError, match='x and y are expected first'):
        match(swapped, line_truth())


def test_scoring_leaves_its_input_alone():
    truth, estimates = noisy_track()
    before = [(e.mean.copy(), e.covariance.copy()) for e in estimates]
    score(estimates, truth)
    for e, (mean, covariance) in zip(estimates, before, strict=True):
        np.testing.assert_array_equal(e.mean, mean)
        np.testing.assert_array_equal(e.covariance, covariance)


@settings(max_examples=25)
@given(st.integers(0, 1000), st.lists(st.integers(1, 59), min_size=1, max_size=3, unique=True))
def test_pooling_the_parts_of_a_run_is_scoring_the_whole(seed, cuts):
    truth, estimates = noisy_track(seed)
    whole = score(estimates, truth, skip_s=0.0)
    edges = [0, *sorted(cuts), len(estimates)]
    parts = [score(estimates[a:b], truth, skip_s=0.0) for a, b in pairwise(edges)]
    pooled = pool(parts)
    # Bit for bit: the epochs are kept, not their means. Only the effective epochs see the seams.
    for name in ('rmse_m', 'median_m', 'p95_m', 'ei_m', 'esi_m', 'nees', 'nees_interval_independent'):
        assert getattr(pooled, name) == getattr(whole, name)
    assert (pooled.epochs, pooled.first_ns, pooled.last_ns) == (whole.epochs, whole.first_ns, whole.last_ns)
    assert pooled.runs == len(parts)
    assert pool([pool(parts[:1]), *parts[1:]]).rmse_m == pooled.rmse_m


def test_pooled_rmse_is_not_the_mean_of_the_rmses():
    truth = line_truth()
    short = score(track(truth, np.full((30, 2), 3.0), EYE)[:6], truth, skip_s=0.0)
    long = score(track(truth, np.full((30, 2), 1.0), EYE), truth, skip_s=0.0)
    assert pool([short, long]).rmse_m == pytest.approx(math.sqrt((6 * 18 + 30 * 2) / 36))


def test_pooling_independent_runs_narrows_the_interval():
    one, other = (score(estimates, truth) for truth, estimates in (noisy_track(1), noisy_track(2)))
    low, high = pool([one, other]).nees_interval
    assert max(one.nees_interval[0], other.nees_interval[0]) < low
    assert high < min(one.nees_interval[1], other.nees_interval[1])


def test_pooling_adds_the_counts_of_every_part():
    one = score(track(line_truth(), np.ones((30, 2))), line_truth())
    pooled = pool([one, one, one])
    assert pooled.unscored['skipped'] == 15
    assert pooled.without_nees['covariance_unknown'] == 75


def test_pooling_nothing_is_refused():
    with pytest.raises(TrackingError, match='no score to pool'):
        pool([])
    with pytest.raises(TrackingError, match='no bag to pool'):
        pool_summaries([])


def report(sent, reasons):
    ids = tuple(range(len(sent) + len(reasons)))
    return TriggerReport(T0, 7, 0, ids[: len(sent)], tuple(sent), ids[len(sent) :], tuple(reasons))


def test_traffic_tells_sent_from_held_back_and_from_too_weak():
    reports = [
        report([1, 2], [Reason.OUT_OF_RADIUS, Reason.UNCHANGED, Reason.NOT_HEARD]),
        report([3], [Reason.NOISY, Reason.NOT_DRAWN, Reason.INVALID]),
    ]
    counted = traffic(reports)
    assert counted == Traffic(sent=3, in_radius=6, received=7, on_board=0)
    assert counted.share == 0.5


def test_the_share_is_unknown_without_reports_or_when_the_motes_decide():
    assert math.isnan(traffic([]).share)
    assert math.isnan(traffic([report([1], [Reason.ON_BOARD])]).share)


def test_pooled_summaries_add_what_bags_count_and_keep_what_only_some_have():
    one, other = a_summary(1), a_summary(5, outputs=('local_1', 'human'), input={'late': 5})
    pooled = pool_summaries([one, other])
    assert list(pooled.outputs) == ['local_1', 'fused_1', 'mean', 'human']
    assert [pooled.outputs[name].runs for name in pooled.outputs] == [2, 1, 2, 1]
    assert pooled.input == {'late': 7, 'duplicate': 3, 'other_target': 0}
    assert pooled.traffic == Traffic(82, 200, 328)
    assert (pooled.epochs, pooled.target_id) == (120, 7)
    assert pool_summaries([one, other._replace(target_id=9)]).target_id is None
    assert pool_summaries([one]).title == one.title
