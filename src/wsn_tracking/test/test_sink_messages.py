"""Messages through a simulated sink, to motes and to its host."""

import pytest
from sink_cases import MOTE, REGISTER, asked, attached, by_and_by, data_of, device, joined
from zstack_cases import message, report_payload

from wsn_tracking.zstack import commands as c


def test_message_to_a_mote_is_confirmed_and_kept():
    sink = joined()
    for k, (dst, status) in enumerate(((MOTE.short, 0), (0xFFFF, 0), (0x5555, 0xCD))):
        request = c.AfDataRequest(dst, 0xE8, 0xE8, 0x10, 7, 0, 30, b'abc')
        assert asked(sink, request, 2.0 + k) == [c.AfDataRequestRsp(0)]
        assert by_and_by(sink, 2.5 + k) == [c.AfDataConfirm(status, 0xE8, 7)]
    assert [(sent.dst, sent.data) for sent in sink.chip.sent] == [(MOTE.short, b'abc'), (0xFFFF, b'abc')]


@pytest.mark.parametrize(
    ('mode_and_address', 'status', 'dst'),
    [
        ('02 3E14000000000000', 0, 0x143E),
        ('03' + MOTE.ieee.to_bytes(8, 'little').hex(), 0, 0x143E),
        ('01 0100000000000000', 0, 0xFFFF),
        ('0F FFFF000000000000', 0, 0xFFFF),
        ('03 0000000000000000', 0xCD, None),
    ],
)
def test_message_may_go_to_any_kind_of_address(mode_and_address, status, dst):
    sink = joined()
    rest = 'E8 0000 E8 1000 07 00 1E 0300 616263'
    assert data_of(sink, 0x2402, mode_and_address + rest, 2.0) == b'\x00'
    assert by_and_by(sink, 3.0) == [c.AfDataConfirm(status, 0xE8, 7)]
    assert [(sent.dst, sent.data) for sent in sink.chip.sent] == ([(dst, b'abc')] if dst else [])
    assert data_of(sink, 0x2402, '07' + mode_and_address[2:] + rest, 4.0) == b'\x02'


def test_message_along_a_route_is_confirmed():
    sink = attached(device())
    assert data_of(sink, 0x2403, 'FFFF E8 E8 1000 07 00 1E 01 3E14 03 616263', 2.0) == b'\x00'
    assert by_and_by(sink, 3.0) == [c.AfDataConfirm(0, 0xE8, 7)]


def test_endpoint_0_is_the_profiles_own():
    assert asked(attached(device()), REGISTER._replace(endpoint=0), 2.0) == [c.AfRegisterRsp(2)]


def test_message_is_refused_without_endpoint_or_network():
    sink = device()
    request = c.AfDataRequest(0xFFFF, 0xE8, 0xE8, 0x10, 7, 0, 30, b'abc')
    assert asked(sink, request) == [c.AfDataRequestRsp(0xC2)]
    asked(sink, c.ZdoStartup(100))
    by_and_by(sink, 1.0)
    assert asked(sink, request, 1.0) == [c.AfDataRequestRsp(0x02)]


def test_message_reaches_only_a_host_that_has_registered():
    sink = device()
    assert sink.incoming(message(report_payload()), 0.0) == []
    assert len(attached(sink).incoming(message(report_payload()), 1.0)) == 1
    assert data_of(sink, 0x2404, 'E8', 1.0) == b'\x00'
    assert data_of(sink, 0x2404, 'E8', 1.0) == b'\x02'
    assert sink.incoming(message(report_payload()), 1.0) == []
    assert sink.chip.counters['undelivered'] == 2
