import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties, report_payload

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.frames import fcs
from wsn_tracking.zstack.lines import MAX_LINE, LineReader, decode_line, encode_line
from wsn_tracking.zstack.payload import Payload, PayloadType
from wsn_tracking.zstack.records import RangeRecord, RssiRecord
from wsn_tracking.zstack.reports import Report

EXAMPLE = b'$WSN,1,3,1,1,1000,7,-60,103,1*7A'
MEANING = Report(Payload(PayloadType.RSSI, 3, 1, 1000, (RssiRecord(1, 7, -60),)), lqi=103, hops=1, per_robot=True)
U8, U16, U32 = st.integers(0, 255), st.integers(0, 2**16 - 1), st.integers(0, 2**32 - 1)
AGE, RSSI = st.none() | st.integers(0, 0xFFFE), st.none() | st.integers(-127, 127)
records = st.builds(RssiRecord, U16, AGE, RSSI, st.just(1), st.none(), st.none())
reports = st.builds(
    lambda node, seq, t_ms, record, lqi, hops: Report(
        Payload(PayloadType.RSSI if record else PayloadType.HEARTBEAT, node, seq, t_ms, record),
        lqi=lqi,
        hops=hops,
        per_robot=True,
    ),
    U16,
    st.none() | U16,
    st.none() | U32,
    st.just(()) | st.tuples(records),
    st.none() | U8,
    st.none() | U8,
)


def sealed(body):
    return b'$%s*%02X' % (body, fcs(body))


def test_example_has_its_meaning():
    assert decode_line(EXAMPLE) == MEANING
    assert encode_line(MEANING) == EXAMPLE + b'\r\n'


@properties
@given(reports)
def test_every_report_survives_the_line(report):
    line = encode_line(report)
    assert len(line) <= MAX_LINE + 2
    assert decode_line(line[:-2]) == report


def test_empty_fields_are_unknown():
    found = decode_line(sealed(b'WSN,1,3,1,,,,,,'))
    assert found == Report(Payload(PayloadType.RSSI, 3, None, None, (RssiRecord(1, None, None),)), per_robot=True)
    assert decode_line(sealed(b'WSN,1,3,,5,,,,,')).payload.type == PayloadType.HEARTBEAT


@pytest.mark.parametrize('at', range(1, len(EXAMPLE)))
def test_every_corrupted_character_is_found(at):
    assert isinstance(decode_line(EXAMPLE[:at] + bytes((EXAMPLE[at] ^ 1,)) + EXAMPLE[at + 1 :]), Bad)


@pytest.mark.parametrize(
    ('line', 'reason'),
    [
        (b'$WSN,1,3,1,1,1000,7,-60,103,1*7B', 'line_checksum'),
        (b'$WSN,1,3,1,1,1000,7,-60,103,1', 'line_field'),
        (sealed(b'WSN,2,3,1,1,1000,7,-60,103,1'), 'line_version'),
        (sealed(b'WSN,1,3,1,1,1000,7,-60,103'), 'line_field'),
        (sealed(b'WSN,1,3,1,1,1000,7,-60,103,1,0'), 'line_field'),
        (sealed(b'WSN,1,,1,1,1000,7,-60,103,1'), 'line_field'),
        (sealed(b'WSN,1,3,1,1,1000,7,-300,103,1'), 'line_field'),
        (sealed(b'WSN,1,3,1,65536,1000,7,-60,103,1'), 'line_field'),
        (sealed(b'WSN,1,3,1,x,1000,7,-60,103,1'), 'line_field'),
        (sealed(b'WSN,1,3,1,1,1000,7,-60,256,1'), 'line_field'),
    ],
)
def test_bad_line_says_why(line, reason):
    assert decode_line(line).reason == reason


def test_lower_case_checksum_and_oldest_age_are_accepted():
    assert decode_line(EXAMPLE.replace(b'7A', b'7a')) == MEANING
    assert decode_line(sealed(b'WSN,1,3,1,1,1000,65535,-128,103,1')).payload.records[0][1:3] == (None, None)


@properties
@given(st.lists(st.tuples(st.text('ab\r\n,*$WSN', max_size=12), reports), max_size=6), st.integers(1, 30))
def test_lines_are_found_whatever_stands_between_and_however_they_are_split(pieces, step):
    stream = b''.join(noise.replace('$', '').encode() + encode_line(report) for noise, report in pieces)
    reader = LineReader()
    lines = [line for at in range(0, len(stream), step) for line in reader.feed(stream[at : at + step])]
    assert [decode_line(line) for line in lines] == [report for _, report in pieces]
    assert reader.held == 0


def test_line_without_an_end_is_ended_by_the_next():
    reader = LineReader()
    assert reader.feed(EXAMPLE + EXAMPLE + b'\r') == [EXAMPLE, EXAMPLE]


def test_line_of_120_characters_is_taken_and_a_longer_one_is_not():
    reader = LineReader()
    longest = b'$WSN,' + b'0' * 115
    assert reader.feed(longest + b'\n') == [longest]
    assert reader.feed(longest + b'0\n' + EXAMPLE + b'\n') == [EXAMPLE]


@properties
@given(st.lists(st.binary(max_size=400), max_size=20))
def test_memory_is_bounded_and_every_byte_is_accounted_for(pieces):
    reader = LineReader()
    for data in pieces:
        reader.feed(data)
        assert reader.held <= MAX_LINE


def test_endless_line_is_dropped_and_counted():
    reader = LineReader()
    for _ in range(100):
        reader.feed(b'$WSN,' + b'1' * 200)
    assert reader.held == 0
    assert reader.counters['long_lines'] > 0
    assert reader.feed(EXAMPLE + b'\n') == [EXAMPLE]


def test_complete_line_can_be_taken_without_its_end():
    reader = LineReader()
    reader.feed(EXAMPLE[:-1])
    assert reader.take_complete() == []
    reader.feed(EXAMPLE[-1:])
    assert reader.take_complete() == [EXAMPLE]


@pytest.mark.parametrize(
    'payload',
    [
        report_payload()._replace(records=report_payload().records * 2),
        Payload(PayloadType.RANGE, 1, 1, 1, (RangeRecord(1, 2, 3, 4, 5),)),
    ],
)
def test_report_that_no_line_can_carry_is_refused(payload):
    with pytest.raises(TrackingError, match=r'expected at most one|signal strengths only'):
        encode_line(Report(payload))
