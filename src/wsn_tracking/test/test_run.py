"""The offline evaluation: what it gives for a recording, and how that is scored."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth
from run_cases import NEAR, TRIGGER, estimators, run

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.evaluation.run_random_q import Sensing
from wsn_tracking.graphs import source_of
from wsn_tracking.offline import offline
from wsn_tracking.sensing.values import EpochEnd, Rssi, TriggerReport
from wsn_tracking.trackers.fusing import FusionConfig


def test_every_output_has_an_estimate_of_every_epoch():
    result = run()
    assert list(result.estimates) == ['local_1', 'local_2', 'local_3', 'fused_1', 'fused_2', 'fused_3', 'mean', 'lci']
    assert result.epochs == 12
    assert result.start_ns == a_loop(12).messages[0].stamp_ns
    for name, estimates in result.estimates.items():
        assert [e.request_seq for e in estimates] == list(range(12))
        assert [e.stamp_ns for e in estimates] == [result.start_ns + k * 10**9 for k in range(12)]
        assert {(e.source, e.target_id) for e in estimates} == {(name, 1)}
        assert np.all(np.isfinite([e.mean for e in estimates]))
    assert [e.contributors for e in result.estimates['fused_2']] == [(1, 2, 3)] * 12
    assert [e.contributors for e in result.estimates['local_2']] == [(2,)] * 12
    assert len(result.reports) == 12
    assert result.dropped == {}


def test_one_estimator_alone_has_nothing_to_be_compared_with():
    assert list(run(configs=estimators(1)).estimates) == ['local_1', 'fused_1']


def test_an_estimator_fuses_its_peers_alone():
    configs = estimators()
    configs[0] = dataclasses.replace(configs[0], peers=(1, 3))
    result = run(configs=configs)
    assert {e.contributors for e in result.estimates['fused_1']} == {(1, 3)}
    assert {e.contributors for e in result.estimates['fused_2']} == {(1, 2, 3)}


def test_an_estimator_that_hears_only_some_nodes_is_one_in_a_field_of_only_those():
    some = (1, 2, 5, 6)
    apart = run(configs=[dataclasses.replace(c, nodes=some if c.id == 1 else ()) for c in estimators()])
    assert {node for e in apart.estimates['local_1'] for node in e.measurements} <= set(some)
    assert differences(apart.estimates['local_2'], run().estimates['local_2']) == []
    full = a_loop(12)
    heard = tuple(m for m in full.messages if not isinstance(m, Rssi) or m.node_id in some)
    ends = tuple(m._replace(node_ids=some, seqs=(m.request_seq,) * 4) if isinstance(m, EpochEnd) else m for m in heard)
    smaller = full._replace(anchors=full.anchors.select(some), messages=ends)
    assert differences(apart.estimates['local_1'], run(smaller).estimates['local_1']) == []


def test_with_feedback_estimators_go_on_from_the_fused_estimate():
    plain, fed = run(), run(configs=estimators(fusion=FusionConfig(feedback=True)))
    assert differences(plain.estimates['local_1'][:1], fed.estimates['local_1'][:1]) == []
    assert differences(plain.estimates['local_1'][1:], fed.estimates['local_1'][1:])
    # after a feedback all estimators share the past: what differs is one epoch's own noise
    spread = {name: np.ptp([r.estimates[f'local_{i}'][-1].mean[:2] for i in (1, 2, 3)], axis=0).max()
              for name, r in (('plain', plain), ('fed', fed))}  # fmt: skip
    assert spread['fed'] < spread['plain']


def test_signal_strengths_may_go_into_the_filters_as_such():
    result = run(sensing=None, configs=[dataclasses.replace(c, input='rssi') for c in estimators()])
    assert {len(e.measurements) for e in result.estimates['local_1']} == {12}
    assert result.reports == ()


def test_what_the_trigger_holds_back_is_not_used():
    result = run(sensing=Sensing(TRIGGER, 0))
    used = sum(len(e.measurements) for e in result.estimates['local_1'])
    assert used == sum(len(report.sent_ids) for report in result.reports)
    assert 0 < used < 12 * 12


# ---- scores


def test_every_output_is_scored_against_the_truth_after_the_start():
    result = run()
    summary = summarise('title', a_loop(12), result, skip_s=5.0)
    assert set(summary.outputs) == set(result.estimates)
    assert (summary.title, summary.target_id, summary.epochs, summary.skip_s) == ('title', 1, 12, 5.0)
    for name, s in summary.outputs.items():
        assert s.epochs == 7
        errors = [
            np.linalg.norm(e.mean[:2] - p[:2])
            for e, p in zip(result.estimates[name][5:], a_loop(12).truth[1].positions[5:], strict=True)
        ]
        assert s.rmse_m == pytest.approx(np.sqrt(np.mean(np.square(errors))))
    assert summary.traffic.sent == sum(len(report.sent_ids) for report in result.reports)
    assert summary.traffic.received == 12 * 12


def test_without_truth_there_is_nothing_to_score():
    recording = without_truth(a_loop(12))
    result = run(recording)
    summary = summarise('title', recording, result)
    assert summary.outputs == {}
    assert summary.target_id == 1
    for name, estimates in run().estimates.items():
        assert differences(estimates, result.estimates[name]) == []  # truth is for the judge alone


# ---- the plan of a graph


def test_a_plan_runs_as_its_parameters_say():
    recording = with_second_target(a_loop(12))
    s = source_of('bag', recording)
    given = {'trigger.kind': 'near', 'trigger.y_min': -50.0}
    one = offline(s, recording, settings=given)
    assert {e.target_id for e in one.estimates['fused_1']} == {1}
    assert {e.target_id for e in offline(s, recording, settings={**given, 'target_id': 4}).estimates['fused_1']} == {4}
    assert {e.target_id for e in offline(s, recording, settings=given, target_id=4).estimates['fused_1']} == {4}
    assert len(offline(s, recording, settings={**given, 'peers': [2]}).estimates) == 2
    raw = offline(s, recording, settings={'input': 'rssi'})
    assert raw.reports == ()
    with pytest.raises(TrackingError, match='has no target 9'):
        offline(s, recording, target_id=9)


def test_a_bag_of_ranges_needs_no_sensing_nodes():
    recording = ranged(a_loop(12), NEAR)
    result = offline(source_of('bag', recording), recording)
    assert all(isinstance(report, TriggerReport) for report in result.reports)
    assert len(result.reports) == 12
