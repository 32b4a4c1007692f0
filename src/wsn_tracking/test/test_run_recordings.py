"""Equal recordings in other forms give equal estimates; what is missing or wrong is counted, or named."""

from __future__ import annotations

import dataclasses
from collections import Counter

import pytest
from graph_cases import a_loop, ranged, with_second_target
from run_cases import NEAR, SENSING, TRIGGER, estimators, run

from wsn_tracking.bags.estimates import differences
from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.run import epochs_of, summarise
from wsn_tracking.evaluation.run_random_q import Sensing, run_random_q
from wsn_tracking.sensing.stage import TriggerConfig
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.trackers.estimate import Kind


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
