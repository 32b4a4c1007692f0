from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import BYTES, line_bytes, message, properties, report_payload

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.protocols import PROTOCOLS, Radio, protocol_of
from wsn_tracking.zstack.records import FeedbackRecord, RssiRecord
from wsn_tracking.zstack.reports import Report

RADIO = Radio()
PLAIN = Payload(PayloadType.RSSI, 3, 1, 1000, (RssiRecord(1, 7, -60),))


def wire(protocol, payload=PLAIN):
    if protocol == 'znp':
        return line_bytes(message(payload))
    if protocol == 'mt_app':
        return line_bytes(c.MtAppRsp(0xE8, encode_payload(payload)))
    return encode_line(Report(payload, lqi=105, hops=1))


def feed(protocol, data):
    line = protocol_of(protocol, RADIO)
    return [*line.feed(data, 0.0), *line.flush()]


@pytest.mark.parametrize('protocol', PROTOCOLS)
def test_all_kinds_of_sink_say_the_same(protocol):
    (report,) = feed(protocol, wire(protocol))
    records = tuple(record._replace(beacon_seq=None) for record in report.payload.records)
    assert report.payload._replace(records=records) == PLAIN
    assert isinstance(report, Report)


@pytest.mark.parametrize('protocol', PROTOCOLS)
@properties
@given(cuts=st.lists(st.integers(0, 200), max_size=10))
def test_items_do_not_depend_on_how_the_stream_is_split(protocol, cuts):
    stream = b'noise' + b''.join(wire(protocol, PLAIN._replace(seq=seq)) for seq in range(5))
    line, items = protocol_of(protocol, RADIO), []
    edges = sorted({0, *(cut for cut in cuts if cut < len(stream)), len(stream)})
    for a, b in pairwise(edges):
        items += line.feed(stream[a:b], 0.0)
    assert items == feed(protocol, stream)
    assert [item.payload.seq for item in items] == list(range(5))


@pytest.mark.parametrize('protocol', PROTOCOLS)
def test_pause_ends_what_is_broken_off(protocol):
    line = protocol_of(protocol, RADIO, gap_s=0.1)
    line.feed(wire(protocol)[:-6], 1.0)
    assert line.held > 0
    items = line.feed(wire(protocol), 1.2)
    assert [item.payload.seq for item in items if isinstance(item, Report)] == [1]
    assert line.held == 0


def test_pause_ends_a_line_that_lacks_only_its_end():
    line = protocol_of('ascii', RADIO, gap_s=0.1)
    assert line.feed(wire('ascii')[:-2], 1.0) == []
    assert [item.payload.seq for item in line.feed(b'', 1.2)] == [1]


def test_tap_sees_every_frame_and_line():
    for protocol in PROTOCOLS:
        seen = []
        line = protocol_of(protocol, RADIO, tap=lambda raw, item, seen=seen: seen.append((raw, item)))
        items = line.feed(wire(protocol) * 3, 0.0)
        assert [item for _, item in seen] == items
        assert len(items) == 3


@pytest.mark.parametrize(
    ('radius', 'hops', 'direct'), [(29, 1, True), (27, 3, False), (30, 1, True), (None, None, None)]
)
def test_hops_are_what_is_missing_of_the_radius(radius, hops, direct):
    mac_src = None if radius is None else 0x143E if direct else 0x5FF6
    (report,) = feed('znp', line_bytes(message(PLAIN)._replace(mac_src=mac_src, radius=radius)))
    assert (report.hops, report.direct, report.src, report.lqi, report.ticks) == (hops, direct, 0x143E, 105, 3125)


@pytest.mark.parametrize(
    ('data', 'reason'),
    [
        (BYTES['AF_IN_1'], 'foreign_endpoint'),
        (line_bytes(message(PLAIN, cluster=6)), 'foreign_cluster'),
        (line_bytes(message(b'\x11' * 22)), 'payload_length'),
        (line_bytes(message(encode_payload(report_payload())[:-1] + b'\x00')), 'payload_crc'),
        (
            line_bytes(message(Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(1, 0, 0, 0, 0),)))),
            'payload_direction',
        ),
        (line_bytes(c.MtAppRsp(0x0B, encode_payload(PLAIN))), 'foreign_endpoint'),
        (line_bytes(c.MtAppRsp(0xE8, b'hello')), 'payload_length'),
        (bytes.fromhex('FE 00 45 55 10'), 'unknown_command'),
    ],
)
def test_what_is_not_ours_is_bad_and_says_why(data, reason):
    (item,) = feed('znp', data)
    assert isinstance(item, Bad)
    assert item.reason == reason


def test_sink_speaking_of_itself_passes():
    assert feed('mt_app', BYTES['SYS_RESET_IND']) == [c.SysResetInd(0, 2, 1, 2, 7, 1)]
