"""Scores and traffic of several bags, pooled."""

import math
from itertools import pairwise

import numpy as np
import pytest
from evaluation_cases import EYE, T0, a_summary, line_truth, noisy_track, track
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.score import pool, score
from wsn_tracking.evaluation.summary import Traffic, pool_summaries, traffic
from wsn_tracking.sensing.values import Reason, TriggerReport


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
