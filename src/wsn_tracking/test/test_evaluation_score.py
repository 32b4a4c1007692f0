"""The score of an output: every estimate is scored, or counted by the reason why not."""

import math

import numpy as np
import pytest
from evaluation_cases import EYE, SECOND, T0, estimate, line_truth, noisy_track, track

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.consistency import nees_interval
from wsn_tracking.evaluation.score import match, score
from wsn_tracking.trackers.estimate import Kind


def test_a_score_is_that_computed_by_hand():
    truth = line_truth(4)
    errors = np.array([[3.0, -4.0], [0.0, 0.0], [-1.0, 0.0], [0.0, 2.0]])
    result = score(track(truth, errors, 2.0 * EYE), truth, skip_s=0.0)
    assert result.rmse_m == pytest.approx(math.sqrt(30 / 4))
    assert result.median_m == pytest.approx(1.5)
    assert result.ei_m == pytest.approx(2.5)
    assert result.esi_m == pytest.approx((4.0, 6.0))
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
    usual, started = (track(truth, np.full((30, 2), 0.1), EYE, kind=kind) for kind in (Kind.LOCAL, Kind.START))
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


@pytest.mark.filterwarnings('error')
def test_a_filter_that_has_run_off_beyond_all_numbers_is_told_to_be_overconfident():
    truth = line_truth()
    result = score(track(truth, np.full((30, 2), 1e100), 1e-250 * np.eye(2)), truth)
    assert math.isinf(result.nees)
    assert result.nees > result.nees_interval[1]


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
