"""Epochs of a bag: kept, completed or derived."""

from __future__ import annotations

import pytest
from bag_cases import NODES, SECOND, START, anchors, measurement
from hypothesis import given, settings
from hypothesis import strategies as st

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import EpochEnd, Range, Request, Rssi, TriggerReport

MILLISECOND = 1_000_000
ANCHORS = anchors()  # one object: recordings compare by it


def recording(messages, level='rssi', dropped=None):
    return Recording(ANCHORS, level, tuple(messages), {}, {}, dropped or {})


def complete(epochs=4, target=1, level='rssi', start=START):
    messages = []
    for k in range(epochs):
        t = start + k * SECOND
        messages.append(Request(t, target, k))
        messages += [measurement(level, t, node, k, target) for node in NODES]
        messages.append(EpochEnd(t, target, k, level, NODES, (k,) * 3, k == epochs - 1))
    return messages


def without(messages, *kinds):
    return [m for m in messages if not isinstance(m, kinds)]


def ends_of(back):
    return [m for m in back.messages if isinstance(m, EpochEnd)]


def test_a_bag_with_ends_is_unchanged():
    bag = recording(complete(), dropped={'truncated': 1})
    assert with_epoch_ends(bag) == bag


def test_ends_are_derived_from_requests():
    assert with_epoch_ends(recording(without(complete(), EpochEnd))) == recording(complete())


def test_requests_and_ends_are_derived_from_stamps():
    assert with_epoch_ends(recording(without(complete(), EpochEnd, Request))) == recording(complete())


@pytest.mark.parametrize('level', ['rssi', 'range', 'observation'])
def test_every_level_has_its_ends(level):
    back = with_epoch_ends(recording(without(complete(level=level), EpochEnd), level))
    assert {end.topic for end in ends_of(back)} == {level}
    assert ends_of(back)[0].node_ids == NODES


def test_ends_of_another_level_are_not_ends():
    bag = recording(complete())
    others = [m._replace(topic='range') if isinstance(m, EpochEnd) else m for m in bag.messages]
    assert with_epoch_ends(recording(others)) == bag


def test_a_topic_of_ends_may_carry_a_namespace():
    bag = recording(complete())
    absolute = [m._replace(topic='/robot/rssi') if isinstance(m, EpochEnd) else m for m in bag.messages]
    assert with_epoch_ends(recording(absolute)) == bag


def test_every_target_ends_once():
    bag = without(complete(target=1) + complete(3, target=2, start=START + MILLISECOND), EpochEnd)
    bag.sort(key=lambda m: m.stamp_ns)
    back = with_epoch_ends(recording(bag))
    assert [(end.target_id, end.request_seq) for end in ends_of(back) if end.final] == [(2, 2), (1, 3)]
    assert len(ends_of(back)) == 7


def test_an_end_comes_after_all_that_it_lists_and_in_order_of_the_requests():
    late = measurement('rssi', START, 9, 0)._replace(seq=77)
    messages = without(complete(3), EpochEnd)
    back = with_epoch_ends(recording([*messages, late])).messages
    ends = [m for m in back if isinstance(m, EpochEnd)]
    assert [end.request_seq for end in ends] == [0, 1, 2]
    assert (ends[0].node_ids, ends[0].seqs) == ((*NODES, 9), (0, 0, 0, 77))
    assert back.index(late) < back.index(ends[0])


def test_a_request_that_nobody_heard_is_an_epoch():
    messages = [m for m in complete(3) if not (isinstance(m, Rssi) and m.request_seq == 1)]
    back = with_epoch_ends(recording(without(messages, EpochEnd)))
    assert [end.node_ids for end in ends_of(back)] == [NODES, (), NODES]


@pytest.mark.parametrize('later', [4 * SECOND, 1000 * SECOND, 0, -100 * SECOND])
def test_numbers_that_begin_anew_are_epochs_of_their_own(later):
    """A target that was restarted, and a bag that was looped: every epoch has its end where it was."""
    bag = recording(m._replace(final=False) if isinstance(m, EpochEnd) else m for m in complete())
    again = recording((*bag.messages, *complete(start=START + later)))
    assert with_epoch_ends(recording(without(again.messages, EpochEnd))) == again


def test_a_request_that_came_twice_asks_once():
    messages = without(complete(), EpochEnd)
    for place, echo in ((1, messages[0]), (9, messages[4]._replace(stamp_ns=messages[4].stamp_ns + MILLISECOND))):
        twice = [*messages[:place], echo, *messages[place:]]
        assert ends_of(with_epoch_ends(recording(twice))) == ends_of(recording(complete()))


def test_a_repeated_packet_is_listed_once():
    messages = without(complete(1), EpochEnd)
    back = with_epoch_ends(recording([*messages, messages[1]]))
    assert ends_of(back)[0].node_ids == NODES
    assert len(back.messages) == len(messages) + 2


def test_measurements_find_their_request_by_time():
    strays = [m._replace(request_seq=900 + m.request_seq) if isinstance(m, Rssi) else m for m in complete()]
    strays = [m._replace(stamp_ns=m.stamp_ns + 20 * MILLISECOND) if isinstance(m, Rssi) else m for m in strays]
    back = with_epoch_ends(recording(without(strays, EpochEnd)))
    assert [m.request_seq for m in back.messages if isinstance(m, Rssi)] == [0] * 3 + [1] * 3 + [2] * 3 + [3] * 3
    assert back.dropped == {}


def test_measurements_of_no_request_are_counted():
    lost = measurement('rssi', START + SECOND // 2, 1, 99)
    other = measurement('rssi', START, 1, 99, target=8)
    back = with_epoch_ends(recording([*without(complete(), EpochEnd), lost, other], dropped={'no_epoch': 1}))
    assert back.dropped == {'no_epoch': 3}
    assert lost not in back.messages


def test_stamps_out_of_order_in_the_log_are_put_right():
    packets = without(complete(), EpochEnd, Request)
    back = with_epoch_ends(recording(packets[::-1]))
    assert [end.request_seq for end in ends_of(back)] == [0, 1, 2, 3]
    assert [end.stamp_ns for end in ends_of(back)] == [START + k * SECOND for k in range(4)]
    assert {end.node_ids for end in ends_of(back)} == {NODES[::-1]}


def test_the_tolerance_is_from_the_first_packet():
    stamps = [0, 30, 49, 51, 99, 102]  # [ms]
    packets = [Rssi(START + t * MILLISECOND, i, 1, i, 0, -50.0) for i, t in enumerate(stamps)]
    assert [end.node_ids for end in ends_of(with_epoch_ends(recording(packets)))] == [(0, 1, 2), (3, 4), (5,)]
    wide = with_epoch_ends(recording(packets), tolerance_s=0.2)
    assert [end.node_ids for end in ends_of(wide)] == [(0, 1, 2, 3, 4, 5)]


@pytest.mark.parametrize('tolerance', [0.0, -1.0, float('nan'), float('inf')])
def test_a_senseless_tolerance_is_refused(tolerance):
    with pytest.raises(TrackingError, match='positive time'):
        with_epoch_ends(recording(complete()), tolerance)


def test_a_report_alone_is_an_epoch_of_its_own():
    heard = measurement('range', START, 1, 0)
    silent = TriggerReport(START + SECOND, 1, 5, (), (), NODES, (2, 2, 2))
    back = with_epoch_ends(recording([heard, silent], 'range'))
    assert [(end.request_seq, end.node_ids) for end in ends_of(back)] == [(0, (1,)), (1, ())]
    assert [m.request_seq for m in back.messages if isinstance(m, TriggerReport)] == [1]
    assert isinstance(heard, Range)


def test_what_is_listed_but_not_there_is_taken_from_the_list():
    messages = complete()
    del messages[2], messages[6]
    back = with_epoch_ends(recording(messages))
    assert back.dropped == {'listed_missing': 2}
    held = {(m.request_seq, m.node_id, m.seq) for m in back.messages if isinstance(m, Rssi)}
    listed = {(e.request_seq, n, s) for e in ends_of(back) for n, s in zip(e.node_ids, e.seqs, strict=True)}
    assert listed == held


def test_a_list_of_unequal_columns_is_cut_to_what_it_says():
    messages = complete(1)
    messages[-1] = messages[-1]._replace(seqs=(0,))
    back = with_epoch_ends(recording(messages))
    assert ends_of(back)[0].node_ids == NODES[:1]
    assert back.dropped == {'listed_missing': 2}


def test_a_cut_recording_ends_with_its_last_whole_epoch():
    cut = complete()[:-2]  # the last epoch lacks a measurement and its end
    back = with_epoch_ends(recording(cut))
    assert [end.final for end in ends_of(back)] == [False, False, True]
    assert back.messages[-1] == ends_of(back)[-1]
    assert back.dropped == {'unfinished_epoch': 3}


def test_an_epoch_whose_end_was_damaged_is_left_out_alone():
    messages = complete()
    messages.remove(ends_of(recording(messages))[1])
    back = with_epoch_ends(recording(messages))
    assert [end.request_seq for end in ends_of(back)] == [0, 2, 3]
    assert {m.request_seq for m in without(back.messages, Request)} == {0, 2, 3}
    assert back.dropped == {'unfinished_epoch': 4}


def test_a_late_packet_of_a_closed_epoch_stays():
    late = measurement('rssi', START, 9, 0)
    back = with_epoch_ends(recording([*complete(), late]))
    assert back.messages[-1] == late


@settings(max_examples=60)
@given(
    packets=st.lists(
        st.tuples(st.integers(0, 4000), st.integers(0, 3), st.integers(1, 3), st.integers(0, 50)), max_size=40
    ),
    asked=st.booleans(),
)
def test_derived_epochs_partition_the_packets_and_are_stable(packets, asked):
    messages = [Rssi(START + t * MILLISECOND, node, target, seq, 7, -50.0) for t, node, target, seq in packets]
    if asked:
        messages = [Request(START + k * 500 * MILLISECOND, 1, k) for k in range(8)] + messages
    bag = recording(messages)
    back = with_epoch_ends(bag)
    heard = [m for m in back.messages if isinstance(m, Rssi)]
    assert len(heard) + back.dropped.get('no_epoch', 0) == len(packets)
    requests = {(m.target_id, m.seq): m for m in back.messages if isinstance(m, Request)}
    assert {(m.target_id, m.request_seq) for m in heard} <= set(requests)
    ends = ends_of(back)
    assert {(e.target_id, e.request_seq) for e in ends} == set(requests)
    assert len(ends) == len(requests)
    for target in {e.target_id for e in ends}:
        finals = [e.final for e in ends if e.target_id == target]
        assert finals == [False] * (len(finals) - 1) + [True]
    assert with_epoch_ends(back) == back


def test_a_lost_request_is_rebuilt_from_the_end_of_its_epoch():
    whole = complete()
    bag = recording([m for m in whole if m != Request(START + SECOND, 1, 1)])
    back = with_epoch_ends(bag)
    assert back.messages == tuple(whole)
    assert back.dropped == {'request_rebuilt': 1}
