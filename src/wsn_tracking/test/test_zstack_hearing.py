"""What a sink says reaches the host, in order, and nothing that it says breaks the host."""

import contextlib
import random
import time

import pytest
from fake_sink import PATIENCE
from session_cases import FAST, IMPATIENT, comes_through, data
from zstack_cases import BYTES, message, report_payload

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack import session as session_module
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.records import RssiRecord
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.session import Session
from wsn_tracking.zstack.settings import LinkConfig


def test_reports_are_delivered_in_order_with_their_arrival(sink, host):
    up = host()
    up.wait_up()
    before = time.monotonic_ns()
    for seq in range(100):
        sink.say(data(seq))
    up.wait_seqs(range(100))
    arrivals = [r.arrival_ns for r in up.received if isinstance(r.item, Report)]
    assert before < arrivals[0] <= arrivals[-1] < time.monotonic_ns()
    assert arrivals == sorted(arrivals)


def test_garbage_partial_frames_and_single_bytes_lose_nothing(sink, host):
    up = host()
    up.wait_up()
    sink.say(b'Boot 1.2\r\n', data(0), b'\xfe\x2a\x44', data(1), data(2)[:20])
    up.wait_seqs(range(2))
    up.wait_counted('gaps')  # the rest of it never comes
    for byte in data(3):
        sink.say(bytes((byte,)))
    broken = bytearray(data(4))
    broken[30] ^= 0x10
    long = bytearray(data(4))
    long[1] = 0xF0
    sink.say(data(4), bytes(broken), bytes(long), b'\xfe\xff', data(5), data(6), data(7))
    up.until(lambda: len(up.seqs) == 7)
    assert up.seqs == [0, 1, 3, 4, 5, 6, 7]
    assert up.counted('bad_fcs') >= 1


def test_line_is_looked_at_when_the_host_asks_for_it(sink, host):
    """Whoever waits for the end of an epoch can be sure that nothing lies unread."""
    up = host()
    up.wait_up()
    sink.say(data(3))
    asked = time.monotonic_ns()
    up.session.look()
    up.until(lambda: (up.session.looked_ns or 0) > asked)
    up.wait_seqs([3])
    sink.unplug()
    up.until(lambda: up.session.looked_ns is None)


def test_slow_host_loses_the_oldest_and_is_told(sink, host):
    up = host(host_queue=10)
    up.until(lambda: up.session.status.up)
    sink.say(*(data(seq) for seq in range(30)))
    end = time.monotonic() + PATIENCE
    while up.session.counters['reports'] < 30:
        assert time.monotonic() < end
    received = up.session.inbox.take()
    assert [r.item.payload.seq for r in received] == list(range(20, 30))
    assert up.counted('host_queue_dropped') >= 20


def test_foreign_and_broken_messages_are_counted(sink, host):
    up = host()
    up.wait_up()
    payload = encode_payload(report_payload())
    sink.say(
        BYTES['AF_IN_1'],
        message(report_payload(), cluster=0x0006),
        message(payload[:-1] + b'\x00'),
        message(b'\x21' + bytes(11) + b'\x00\x00'),
        bytes.fromhex('FE 00 45 55 10'),
        data(1),
    )
    up.wait_seqs([1])
    names = ('foreign_endpoint', 'foreign_cluster', 'payload_crc', 'unknown_command')
    assert [up.counted(name) for name in names] == [1, 1, 2, 1]


def sound_but_hostile(draw, count):
    """Frames that are sound, of any command or none, with data that mean nothing."""
    for _ in range(count):
        header = draw.choice([*c.BY_HEADER, draw.randrange(1 << 16)])
        yield encode_frame(Frame(header, draw.randbytes(draw.choice([0, 1, 3, 5, 14, 24, 60, 250]))))


@pytest.mark.parametrize('seed', range(3))
def test_nothing_that_a_sink_says_breaks_the_host(sink, host, seed):
    """Noise, sound frames of any command with any data, unasked answers, restarts: afterwards reports come."""
    draw = random.Random(seed)
    up = host(host_queue=50)
    up.wait_up()
    for _ in range(20):
        sink.say(*sound_but_hostile(draw, 20))
        sink.say(draw.randbytes(200))
        up.received.clear()
    up.until(comes_through(up, sink, 7))
    assert up.counted('internal_errors') == 0


def test_indications_reach_the_host(sink, host):
    up = host()
    up.wait_up()
    sink.say(BYTES['ENDDEV_ANNCE'], BYTES['SRC_RTG_IND_2'])
    up.session.ask(c.ZdoMgmtLqiReq(0, 0), c.ZdoMgmtLqiReqRsp)
    sink.wait_asked(c.ZdoMgmtLqiReq)
    sink.say(BYTES['MGMT_LQI_RSP'])
    kinds = (c.ZdoEndDeviceAnnceInd, c.ZdoSrcRtgInd, c.ZdoMgmtLqiRsp)
    up.until(lambda: {type(r.item) for r in up.received} >= set(kinds))


@pytest.mark.parametrize('protocol', ['mt_app', 'ascii'])
def test_other_kinds_of_sink_are_only_listened_to(sink, host, protocol):
    up = host(sink_protocol=protocol, timeout=IMPATIENT)
    up.wait_up()
    for seq in range(5):
        payload = Payload(PayloadType.RSSI, 3, seq, 1000, (RssiRecord(1, 7, -60),))
        says = encode_line(Report(payload)) if protocol == 'ascii' else c.MtAppRsp(0xE8, encode_payload(payload))
        sink.say(b'text\r\n', says)
    up.wait_seqs(range(5))
    assert sink.asked == []


def test_fault_of_the_host_does_not_end_the_link(sink, link):
    def wake():
        raise RuntimeError('a fault of the host')

    session = Session(LinkConfig(port=str(link), timeout=FAST), wake)
    session.start()
    with contextlib.closing(session):
        sink.wait_asked(c.ZdoExtNwkInfo)
    assert [item for item, _ in session.inbox.take()] == [LinkEvent('opened', sink.device), LinkEvent('up')]
    assert session.counters['internal_errors'] == 2


def test_fault_of_ours_opens_the_port_again(sink, host, monkeypatch):
    faults = iter([RuntimeError('a fault of ours')])

    def attach(*arguments):
        for fault in faults:
            raise fault
        return real(*arguments)

    real = session_module.attach
    monkeypatch.setattr(session_module, 'attach', attach)
    up = host()
    up.wait_up()
    assert (up.counted('internal_errors'), up.counted('opened')) == (1, 2)
