"""The simulated firmware answers as captured sinks did, and brings its network up as they do."""

import pytest
from sink_cases import BOTH, asked, attached, data_of, device, frame, understood
from zstack_cases import BYTES, VECTORS, line_bytes

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.device import IEEE
from wsn_tracking.zstack.frames import encode_frame

# ---- against captured frames


@pytest.mark.parametrize(
    ('request_id', 'answer_id'),
    [
        ('SYS_PING_SREQ', 'SYS_PING_SRSP_cc2531'),
        ('SYS_VERSION_SREQ', 'SYS_VERSION_14'),
        ('NV_WRITE_STARTUP2', 'NV_WRITE_SRSP_OK'),
        ('NV_WRITE_PANID', 'NV_WRITE_SRSP_OK'),
    ],
)
def test_captured_question_is_answered_as_it_was(request_id, answer_id):
    assert device().feed(BYTES[request_id], 0.0) == BYTES[answer_id], VECTORS[answer_id]['meaning']


def test_start_of_a_new_network_is_told_as_it_was():
    sink = device(network=None)
    assert sink.feed(BYTES['ZDO_STARTUP_100'], 0.0) == BYTES['ZDO_STARTUP_SRSP_new']
    told = [encode_frame(f) for f in sink.advance(10.0)]
    assert told == [BYTES['ZDO_STATE_8']] * 3 + [line_bytes(c.ZdoStateChangeInd(9))]


def test_device_info_is_as_it_was():
    captured = understood(BYTES['UTIL_DEVINFO_SRSP'])[0]
    sink = device(ieee=captured.ieee, up=True)
    assert sink.feed(line_bytes(c.UtilGetDeviceInfo()), 0.0) == BYTES['UTIL_DEVINFO_SRSP']


def test_formation_begins_as_it_was():
    assert device('zstack_3_0').feed(BYTES['BDB_START'], 0.0) == BYTES['BDB_START_SRSP']


@pytest.mark.parametrize('name', ['P1_one_range', 'P0_heartbeat'])
def test_message_is_passed_on_as_it_was(name):
    (captured,) = understood(BYTES[name])
    sink = attached(device(first_tick=captured.timestamp))
    sink.chip.booted = sink.chip.now
    assert [encode_frame(f) for f in sink.incoming(captured._replace(timestamp=0), 1.0)] == [BYTES[name]]


# ---- what is asked


@BOTH
def test_version_fits_the_flavour(flavour):
    (version,) = asked(device(flavour), c.SysVersion())
    assert (version.product, version.stack) == {
        'home_1_2': (0, 'Z-Stack Home 1.2'),
        'zstack_3_0': (2, 'Z-Stack 3.0.x'),
    }[flavour]


@pytest.mark.parametrize(
    ('flavour', 'header', 'code'),
    [
        ('home_1_2', 0x21FE, 2),
        ('home_1_2', 0x2808, 1),
        ('home_1_2', 0x2F05, 1),
        ('zstack_3_0', 0x2604, 1),
        ('zstack_3_0', 0x2FAA, 2),
        ('home_1_2', 0x2400, 4),
        ('home_1_2', 0x2108, 4),
    ],
)
def test_what_is_not_understood_is_refused_with_the_reason(flavour, header, code):
    (error,) = asked(device(flavour), encode_frame(frame(header, '04')))
    assert error == c.RpcError(code, header >> 8, header & 0xFF)


def test_unknown_indication_from_the_host_is_not_answered():
    assert asked(device(), encode_frame(frame(0x41AA))) == []


@pytest.mark.parametrize(
    ('header', 'data', 'answer'),
    [
        (0x2104, '', IEEE.to_bytes(8, 'little').hex()),
        (0x2114, '14', '04'),
        (0x2114, 'F6', 'f6'),
        (0x210F, '00 05', '05'),
        (0x2706, '0000 01', '00'),
        (0x270A, '03 01', '00'),
        (0x2709, '', '00000000'),
        (0x2748, '00 06', '0000'),
        (0x274A, '00' * 10, 'ff' * 28),
        (0x2410, '00 00', '00'),
        (0x2545, '3E14 00 1E', '00'),
        (0x2546, '3E14 00 00', '04'),
        (0x253F, 'FFFF', '00'),
        (0x2608, 'FCFF 3C', '00'),
    ],
)
def test_small_questions_are_answered(header, data, answer):
    assert data_of(device(), header, data).hex() == answer


def test_timers_expire():
    sink = device()
    assert data_of(sink, 0x210A, '02 E803') == b'\x00'
    assert sink.advance(0.99) == []
    assert sink.advance(1.01) == [frame(0x4181, '02')]
    assert data_of(sink, 0x210A, '04 E803', 1.1) == b'\x02'
