"""What a sink delivers becomes requests, measurements and epoch ends."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties

from wsn_tracking.bridging import TARGETS, Bridge, Rules
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.values import EpochEnd, Modality, Range, Reason, Request, Rssi, TriggerReport
from wsn_tracking.zstack.duplicates import Verdict
from wsn_tracking.zstack.intake import Taken
from wsn_tracking.zstack.nodes import Judged
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType
from wsn_tracking.zstack.records import RangeRecord, RssiRecord
from wsn_tracking.zstack.reports import Report

MS = 1_000_000
OFFSET = 1_700_000_000_000_000_000
TIMEOUT = 400 * MS


def bridge(node_ids=None):
    return Bridge(Rules(TIMEOUT, int(Modality.ULTRASOUND), node_ids or {}), OFFSET)


def taken(payload, at_ms, verdict=Verdict.NEW):
    return Taken(Report(payload), at_ms * MS, Judged(verdict))


def rssi(node, seq, *records, flags=0):
    return Payload(PayloadType.RSSI, node, seq, 0, records, flags)


def test_reports_of_one_request_share_its_number_and_stamp():
    b = bridge()
    first = list(b.take(taken(rssi(3, 10, RssiRecord(1, 20, -50, beacon_seq=7)), 1020), 1021 * MS))
    second = list(b.take(taken(rssi(4, 99, RssiRecord(1, 35, -60, 2, 1.5, 7)), 1038), 1040 * MS))
    stamp = OFFSET + 1000 * MS  # reception less the age
    assert first == [Request(stamp, 1, 7), Rssi(stamp, 3, 1, 80, 7, -50.0, pytest.approx(math.nan, nan_ok=True))]
    assert second == [Rssi(stamp, 4, 1, 792, 7, -60.0, 1.5, 2)]
    assert list(b.due(1420 * MS)) == []
    assert list(b.due(1421 * MS)) == [EpochEnd(stamp, 1, 7, 'rssi', (3, 4), (80, 792))]


def test_numbers_of_requests_go_on_beyond_255():
    b = bridge()
    seqs = []
    for k in range(600):
        values = list(b.take(taken(rssi(3, k, RssiRecord(1, 0, -50, beacon_seq=k % 256)), 1000 * k), 1000 * k * MS))
        seqs += [v.seq for v in values if isinstance(v, Request)]
        list(b.due((1000 * k + 500) * MS))
    assert seqs == list(range(600))


def test_a_duplicate_gives_nothing_and_a_late_word_is_handed_on_and_counted():
    b = bridge()
    report = taken(rssi(3, 1, RssiRecord(1, 0, -50, beacon_seq=1)), 0)
    assert len(list(b.take(report, 0))) == 2
    assert list(b.take(report._replace(judged=Judged(Verdict.DUPLICATE)), 0)) == []
    assert len(list(b.due(TIMEOUT))) == 1
    late = list(b.take(taken(rssi(4, 1, RssiRecord(1, 450, -55, beacon_seq=1)), 450), 460 * MS))
    assert [type(v) for v in late] == [Rssi]
    assert late[0].request_seq == 1
    assert b.counters['after_epoch_end'] == 1


def test_ranges_and_worn_nodes_and_triggers_on_board():
    b = bridge()
    payload = Payload(PayloadType.RANGE, 5, 2, 0, (RangeRecord(9, 0, 1234, 20, 4),), Flag.EVENT_TRIGGERED)
    _, measured = b.take(taken(payload, 0), 0)
    assert (measured.node_id, measured.target_id, measured.modality) == (5, 9, Modality.ULTRASOUND)
    assert measured.range == pytest.approx(1.234)
    assert measured.variance == pytest.approx(4e-4)
    report, end = b.due(TIMEOUT)
    assert isinstance(report, TriggerReport)
    assert (report.sent_ids, report.sent_seqs) == ((5,), (measured.seq,))
    assert (end.topic, end.node_ids) == ('range', (5,))
    worn = Payload(
        PayloadType.WORN, 40, 0, 0, (RssiRecord(6, 0, -70, beacon_seq=0), RssiRecord(7, 0, -71, beacon_seq=0))
    )
    values = list(b.take(taken(worn, 5000), 5000 * MS))
    assert [(v.node_id, v.target_id) for v in values if isinstance(v, Rssi)] == [(6, 40), (7, 40)]


def test_a_node_that_stays_silent_is_listed_with_its_reason():
    b = bridge()
    list(b.take(taken(rssi(9, 0, RssiRecord(1, 0, -50, beacon_seq=0)), 0), 0))  # node 9 triggers nothing on board
    for k, nodes in enumerate([(1, 2), (1,)]):
        for node in nodes:
            payload = rssi(node, k, RssiRecord(1, 0, -50, beacon_seq=k), flags=Flag.EVENT_TRIGGERED)
            list(b.take(taken(payload, 1000 * k), 1000 * k * MS))
        values = list(b.due((1000 * k + 500) * MS))
    assert (values[0].silent_ids, values[0].reasons) == ((2,), (Reason.ON_BOARD,))


def test_what_cannot_be_used_is_counted():
    b = bridge({300: 3})
    records = (RssiRecord(1, None, -50, beacon_seq=1), RssiRecord(1, 0, None, beacon_seq=1))
    assert [type(v) for v in b.take(taken(rssi(300, 1, *records), 0), 0)] == [Request]
    assert list(b.take(taken(rssi(301, 1, RssiRecord(1, 0, -50, beacon_seq=1)), 0), 0)) == []
    assert +b.counters == {'too_old': 1, 'rssi_invalid': 1, 'unmapped_node': 1}


def test_epochs_of_a_target_end_in_order():
    b = bridge()
    for k in (3, 4):
        list(b.take(taken(rssi(1, k, RssiRecord(1, 0, -50, beacon_seq=k)), 100 * k), 100 * k * MS))
    ends = [v.request_seq for v in b.due(10_000 * MS) if isinstance(v, EpochEnd)]
    assert ends == [3, 4]


def test_next_end_is_that_of_the_epoch_that_began_first():
    b = bridge()
    assert b.next_due_ns is None
    for k, at in ((3, 100), (4, 200)):
        list(b.take(taken(rssi(1, k, RssiRecord(1, 0, -50, beacon_seq=k)), at), at * MS))
    assert b.next_due_ns == 100 * MS + TIMEOUT
    list(b.due(100 * MS + TIMEOUT))
    assert b.next_due_ns == 200 * MS + TIMEOUT
    list(b.due(200 * MS + TIMEOUT))
    assert b.next_due_ns is None


def test_a_range_keeps_no_variance_that_was_not_told():
    b = bridge()
    payload = Payload(PayloadType.RANGE, 5, 2, 0, (RangeRecord(9, 0, 1000, 0, 4),))
    measured = next(v for v in b.take(taken(payload, 0), 0) if isinstance(v, Range))
    assert math.isnan(measured.variance)


def test_whole_decibels_that_are_all_alike_are_not_free_of_error():
    b = bridge()
    measured = list(b.take(taken(rssi(3, 1, RssiRecord(1, 0, -50, 5, 0.0, beacon_seq=1)), 0), 0))[1]
    assert math.isnan(measured.sigma_db)
    assert usable(measured)


def test_memory_is_bounded_whatever_robots_are_told_of():
    """A word of one robot more makes the one that was silent for longest a new one; nobody else notices."""
    b = bridge()
    for robot in range(4 * TARGETS):
        list(b.take(taken(rssi(1, robot, RssiRecord(robot, 0, -50, beacon_seq=9)), robot), robot * MS))
        list(b.take(taken(rssi(1, robot, RssiRecord(5000, 0, -50, beacon_seq=robot % 256)), robot), robot * MS))
    again = list(b.take(taken(rssi(1, 0, RssiRecord(5000, 0, -50, beacon_seq=0)), 4 * TARGETS), 0))
    assert [type(v) for v in again] == [Request, Rssi]
    assert again[0].seq == 4 * TARGETS  # it goes on counting
    ends = list(b.due(10**15))
    assert len({end.target_id for end in ends}) == 4 * TARGETS + 1
    assert list(b.due(10**15)) == []


records = st.one_of(
    st.builds(
        RssiRecord,
        st.integers(0, 3),
        st.one_of(st.none(), st.integers(0, 65534)),
        st.one_of(st.none(), st.integers(-127, 127)),
        st.integers(0, 255),
        st.one_of(st.none(), st.floats(0.0, 15.8)),
        st.integers(0, 255),
    ),
    st.builds(
        RangeRecord,
        st.integers(0, 3),
        st.one_of(st.none(), st.integers(0, 65534)),
        st.integers(0, 65535),
        st.integers(0, 255),
        st.integers(0, 255),
    ),
)


@properties
@given(
    st.lists(
        st.tuples(
            st.sampled_from([1, 2, 3, 4]),
            st.integers(0, 5),
            st.integers(0, 65535),
            st.lists(records, max_size=8),
            st.integers(0, 15),
            st.integers(-5000, 5000),
        ),
        max_size=40,
    )
)
def test_whatever_nodes_say_becomes_epochs_in_order(words):
    """Any records at any age: each epoch is asked for once, before its measurements, and ends once."""
    b, now, values = bridge(), 0, []
    for kind, node, seq, said, flags, step in words:
        now += abs(step)
        values += b.take(taken(Payload(kind, node, seq, 0, tuple(said), flags), now + step), now * MS)
        values += b.due(now * MS)
    values += b.due(10**15)
    asked, ended = {}, set()
    for value in values:
        key = value.target_id, (value.seq if isinstance(value, Request) else value.request_seq)
        if isinstance(value, Request):
            assert key not in asked
            asked[key] = value.stamp_ns
        elif isinstance(value, EpochEnd):
            assert key not in ended
            ended.add(key)
        assert value.stamp_ns == asked[key]
    assert ended == set(asked)
