"""The offline evaluation: what it gives for every kind of recording."""

from __future__ import annotations

import dataclasses
from collections import Counter

import numpy as np
import pytest
from graph_cases import a_loop, ranged, with_second_target, without_truth

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import Sensing, epochs_of, run_random_q, summarise
from wsn_tracking.graphs import source_of
from wsn_tracking.offline import offline
from wsn_tracking.sensing.stage import TriggerConfig
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi, TriggerReport
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.trackers.estimator import EstimatorConfig
from wsn_tracking.trackers.fusing import FusionConfig

TRIGGER = TriggerConfig(alpha=0.3)
NEAR = TriggerConfig(kind='near', y_min=-50.0)
SENSING = Sensing(NEAR, 0)
AREA = (0.0, 0.0, 3.6, 2.4)


def estimators(n=3, **options):
    base = EstimatorConfig(peers=tuple(range(1, n + 1)), input='range', area=AREA, **options)
    return [dataclasses.replace(base, id=number) for number in range(1, n + 1)]


def run(recording=None, sensing=SENSING, configs=None, target_id=-1):
    return run_random_q(recording or a_loop(12), sensing, configs or estimators(), target_id)


# ---- what comes out


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


# ---- equal recordings, other forms


@pytest.mark.parametrize('trigger', [TRIGGER, NEAR, TriggerConfig(kind='always')], ids=lambda t: t.kind)
@pytest.mark.parametrize('reports', [True, False])
def test_ranges_that_were_recorded_give_what_the_signal_strengths_gave_to_the_last_bit(trigger, reports):
    """A bag may enter at either level: the trigger is replayed, or it has happened."""
    sensed = run(sensing=Sensing(trigger, 0))
    replayed = run(ranged(a_loop(12), trigger, reports=reports), sensing=None)
    assert set(sensed.estimates) == set(replayed.estimates)
    for name, estimates in sensed.estimates.items():
        assert differences(estimates, replayed.estimates[name]) == []
    assert replayed.reports == (sensed.reports if reports else ())


def test_the_order_within_an_epoch_changes_nothing():
    messages = []
    for k in range(12):
        epoch = a_loop(12).messages[14 * k : 14 * k + 14]
        messages += [epoch[-1], *epoch[-2:0:-1], epoch[0]]  # the end first, the request last
    shuffled = run(a_loop(12)._replace(messages=tuple(messages)))
    for name, estimates in run().estimates.items():
        assert differences(estimates, shuffled.estimates[name]) == []


def test_another_target_in_between_changes_nothing():
    both = with_second_target(a_loop(12))
    for target_id in (-1, 1):
        result = run(both, target_id=target_id)
        for name, estimates in run().estimates.items():
            assert differences(estimates, result.estimates[name]) == []
        assert result.dropped == {'other_target': 12 * 14}
    other = run(both, target_id=4)
    assert {e.target_id for e in other.estimates['fused_1']} == {4}
    assert other.epochs == 12


def test_reports_of_another_target_are_not_counted():
    both = with_second_target(ranged(a_loop(12), NEAR))
    result = run(both, sensing=None, target_id=4)
    assert {report.target_id for report in result.reports} == {4}
    assert len(result.reports) == 12


def test_a_looped_recording_starts_anew():
    """As the graph does: the second run is the first again, sensing nodes included."""
    once = a_loop(8)
    twice = once._replace(messages=once.messages * 2)
    result, single = run(twice, Sensing(TRIGGER, 0)), run(once, Sensing(TRIGGER, 0))
    assert result.epochs == 16
    for name, estimates in single.estimates.items():
        assert differences(result.estimates[name][:8], estimates) == []
        assert differences(result.estimates[name][8:], estimates) == []
    assert result.reports[8:] == single.reports
    assert result.dropped == {}


def test_a_target_that_counts_anew_is_tracked_on():
    once = a_loop(12)
    anew = []
    for message in once.messages:
        number = message.seq if isinstance(message, Request) else message.request_seq
        field = 'seq' if isinstance(message, Request) else 'request_seq'
        anew.append(message._replace(**{field: number - 7 if number >= 7 else number}))
    result = run(once._replace(messages=tuple(anew)))
    assert result.epochs == 12
    assert [e.request_seq for e in result.estimates['fused_1']] == [*range(7), *range(5)]
    assert differences(result.estimates['fused_1'][:7], run().estimates['fused_1'][:7]) == []
    assert {e.kind for e in result.estimates['fused_1'][7:]} == {Kind.FUSED}  # no new start: the track goes on
    assert result.dropped == {}


# ---- what is missing or wrong


def test_invalid_values_are_counted_and_not_used():
    messages = [
        m._replace(rssi_dbm=127.0) if isinstance(m, Rssi) and m.node_id == 5 and m.request_seq < 3 else m
        for m in a_loop(12).messages
    ]
    for sensing, name in ((SENSING, 'range'), (None, 'rssi')):
        result = run(
            a_loop(12)._replace(messages=tuple(messages), dropped={'undecodable': 2}),
            sensing,
            [dataclasses.replace(c, input=name) for c in estimators()],
        )
        assert result.dropped == {'invalid': 3, 'undecodable': 2}
        assert all(5 not in e.measurements for e in result.estimates['local_1'][:3])


def test_an_epoch_that_lacks_something_is_an_error_that_names_it():
    """The graph would wait for it in vain."""
    whole = a_loop(5)
    missing = {
        'its request': lambda m: isinstance(m, Request) and m.seq == 2,
        'the measurements (node, seq) [(7, 2)]': lambda m: isinstance(m, Rssi) and (m.node_id, m.seq) == (7, 2),
        'the list of nodes': lambda m: isinstance(m, EpochEnd) and m.request_seq == 2,
    }
    for words, left_out in missing.items():
        broken = whole._replace(messages=tuple(m for m in whole.messages if not left_out(m)))
        with pytest.raises(TrackingError) as error:
            run(broken)
        assert f'epoch 2 lacks {words}' in str(error.value)


def test_what_waits_for_a_request_that_never_comes_is_counted():
    whole = a_loop(3)
    cut = whole._replace(messages=tuple(m for m in whole.messages if not (isinstance(m, Request) and m.seq == 2)))
    result = run(cut)
    assert result.epochs == 2
    assert result.dropped == {'no_request': 13}


def test_no_epoch_gives_no_output():
    result = run(a_loop(3)._replace(messages=()))
    assert (result.estimates, result.epochs, result.start_ns, result.reports) == ({}, 0, 0, ())
    summary = summarise('nothing', a_loop(3), result)
    assert (summary.outputs, summary.target_id, summary.epochs) == ({}, None, 0)


def test_epochs_of_tells_counters_and_new_runs():
    counters, calls = Counter(), []
    once = a_loop(3)
    epochs = list(epochs_of(once._replace(messages=once.messages * 2), 1, counters, lambda: calls.append(1)))
    assert [epoch.request_seq for epoch in epochs] == [0, 1, 2, 0, 1, 2]
    assert calls == [1]
    assert counters['used'] == 3 * 12  # counters are those of the last run
    assert len(list(epochs_of(once, -1, Counter()))) == 3


def test_progress_sees_every_epoch():
    seen = []

    def progress(epochs, total):
        seen.append(total)
        for epoch in epochs:
            seen.append(epoch.request_seq)
            yield epoch

    run_random_q(a_loop(5), SENSING, estimators(1), progress=progress)
    assert seen == [5, 0, 1, 2, 3, 4]


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
