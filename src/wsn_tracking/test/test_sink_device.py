"""The simulated firmware answers what hosts ask, as real sinks do."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sink_cases import REGISTER, asked, attached, by_and_by, device, frame, understood
from zstack_cases import BYTES, VECTORS, line_bytes, message, parse, properties, report_payload

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.device import DEFAULT_NETWORK, IEEE
from wsn_tracking.zstack.firmware.chip import TICK_MODULUS, Mote
from wsn_tracking.zstack.firmware.nib import NO_NETWORK, Network, pack_nib, unpack_nib
from wsn_tracking.zstack.firmware.reader import FirmwareReader
from wsn_tracking.zstack.frames import Frame, Kind, encode_frame

BOTH = pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
MOTE = Mote(0x143E, 0x00124B0014000003)


def data_of(sink, header, data='', now=0.0):
    """The data of the one answer to a request that our side has no command for."""
    said = parse(sink.feed(encode_frame(frame(header, data)), now))
    (answer,) = [each for each in said if each.kind == Kind.SRSP]
    assert answer.header == header + 0x4000, answer
    return answer.data


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


# ---- answers


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


@BOTH
def test_network_that_is_remembered_is_restored(flavour):
    sink = device(flavour)
    assert asked(sink, c.UtilGetDeviceInfo())[0].state == 0
    assert asked(sink, c.ZdoStartup(100)) == [c.ZdoStartupRsp(0)]
    assert by_and_by(sink, 1.0) == [c.ZdoStateChangeInd(9)]
    info = asked(sink, c.ZdoExtNwkInfo(), 1.0)[0]
    assert (info.state, info.pan_id, info.channel, info.ext_pan) == (9, 0x1A62, 11, DEFAULT_NETWORK.ext_pan)


@BOTH
def test_network_information_of_a_sink_that_is_down_names_none(flavour):
    info = asked(device(flavour), c.ZdoExtNwkInfo())[0]
    assert (info.state, info.channel, info.pan_id) == (0, 0, 0xFFFF)


@BOTH
def test_registration_is_lost_at_a_reset(flavour):
    sink = attached(device(flavour))
    already = asked(sink, REGISTER, 1.0)[0].status
    assert already in c.ALREADY_REGISTERED
    assert asked(sink, c.SysResetReq(1), 2.0) == []
    (reset,) = by_and_by(sink, 3.0)
    assert isinstance(reset, c.SysResetInd)
    assert asked(sink, c.UtilGetDeviceInfo(), 3.0)[0].state == 0
    attached(sink, 3.0)


def test_watchdog_says_so():
    sink = attached(device())
    sink.reset(2.0)
    assert by_and_by(sink, 3.0)[0].cause == 'watchdog'


def test_sink_that_starts_is_deaf_until_it_says_so():
    sink = attached(device())
    sink.reset(5.0)
    assert asked(sink, c.SysPing(), 5.001) == []
    assert by_and_by(sink, 5.1) == [c.SysResetInd(2, 2, 0, 2, 6, 3)]
    assert asked(sink, c.SysPing(), 5.1) == [c.SysPingRsp(0x0179)]


@BOTH
def test_forming_gives_the_network_that_memory_asks_for(flavour):
    sink = device(flavour)
    assert asked(sink, c.NvWrite(3, 0, b'\x03')) == [c.NvWriteRsp(0)]
    asked(sink, c.SysResetReq(1))
    by_and_by(sink, 1.0)
    assert asked(sink, c.NvRead(3, 0), 1.0) == [c.NvReadRsp(0, b'\x00')]
    for item, value in ((0x83, b'\x63\x1a'), (0x84, (1 << 15).to_bytes(4, 'little'))):
        assert asked(sink, c.NvWrite(item, 0, value), 2.0) == [c.NvWriteRsp(0)]
    if flavour == 'zstack_3_0':
        assert asked(sink, c.BdbSetChannel(1, 1 << 20), 3.0) == [c.BdbSetChannelRsp(0)]
        assert asked(sink, c.BdbSetChannel(0, 0), 3.0) == [c.BdbSetChannelRsp(0)]
        assert asked(sink, c.BdbStartCommissioning(4), 3.0) == [c.BdbStartCommissioningRsp(0)]
        told = by_and_by(sink, 10.0)
        assert told[-1] == c.BdbCommissioningNotification(0, 2, 0)
        assert c.ZdoStateChangeInd(9) in told
        channel = 20
    else:
        assert asked(sink, c.ZdoStartup(100), 3.0) == [c.ZdoStartupRsp(1)]
        assert by_and_by(sink, 10.0)[-1] == c.ZdoStateChangeInd(9)
        channel = 15
    info = asked(sink, c.ZdoExtNwkInfo(), 10.0)[0]
    assert (info.channel, info.pan_id, info.ext_pan) == (channel, 0x1A63, IEEE)
    asked(sink, c.SysResetReq(1), 10.0)
    by_and_by(sink, 11.0)
    assert asked(sink, c.ZdoStartup(100), 11.0) == [c.ZdoStartupRsp(0)]


def test_commissioning_again_restores_on_zstack_3():
    sink = device('zstack_3_0')
    asked(sink, c.BdbStartCommissioning(4))
    told = by_and_by(sink, 5.0)
    assert told[0] == c.ZdoStateChangeInd(9)
    assert told[1] == c.BdbCommissioningNotification(13, 0, 4)
    assert asked(sink, c.BdbStartCommissioning(2), 5.0)[0].status != 0


# ---- memory


def test_memory_by_its_commands():
    sink = device()
    assert data_of(sink, 0x2113, '60 00') == bytes(2)
    assert data_of(sink, 0x2108, '60 00 00') == bytes.fromhex('02 00')
    assert data_of(sink, 0x2109, '60 00 00 01 55') == b'\x02'
    assert data_of(sink, 0x2107, '60 00 03 00 01 55') == b'\x09'
    assert data_of(sink, 0x2107, '60 00 03 00 01 77') == b'\x00'
    assert data_of(sink, 0x2108, '60 00 00') == bytes.fromhex('00 03 55 FF FF')
    assert data_of(sink, 0x211D, '60 00 01 00 02 00 66 77') == b'\x00'
    assert data_of(sink, 0x211C, '60 00 01 00') == bytes.fromhex('00 02 66 77')
    assert data_of(sink, 0x2112, '60 00 02 00') == b'\x0c'
    assert data_of(sink, 0x2112, '60 00 03 00') == b'\x00'
    assert data_of(sink, 0x2112, '60 00 03 00') == b'\x09'


@pytest.mark.parametrize(('flavour', 'status'), [('home_1_2', 2), ('zstack_3_0', 0)])
def test_keys_are_guarded_as_the_firmware_does(flavour, status):
    sink = device(flavour)
    assert data_of(sink, 0x2113, '62 00') == b'\x10\x00'
    assert data_of(sink, 0x211C, '62 00 00 00')[0] == status
    if flavour == 'home_1_2':
        assert data_of(sink, 0x2605, '62 10' + '0D' * 16) == b'\x00'
        assert data_of(sink, 0x2604, '62') == bytes.fromhex('00 62 10') + b'\x0d' * 16


@BOTH
def test_structs_have_the_lengths_by_which_hosts_tell_a_cc253x(flavour):
    sink = device(flavour)
    assert data_of(sink, 0x2113, '82 00') == b'\x15\x00'
    assert data_of(sink, 0x2113, '21 00') == b'\x6e\x00'
    assert len(data_of(sink, 0x2749, '00')) == 28


@properties
@given(
    st.integers(11, 26), st.integers(0, 0xFFFE), st.integers(0, 2**64 - 1), st.integers(0, 0xFFFF),
    st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_network_survives_its_struct(channel, pan_id, ext_pan, short, channels):
    network = Network(channel, pan_id, ext_pan, short, channels)
    assert unpack_nib(pack_nib(network)) == network


def test_struct_of_no_network_is_none():
    assert unpack_nib(pack_nib(NO_NETWORK)) == NO_NETWORK
    assert unpack_nib(pack_nib(DEFAULT_NETWORK)[:-1]) == NO_NETWORK
    assert device('zstack_3_0', network=None).chip.memory.network == NO_NETWORK


# ---- what the sink and its motes say of themselves


def test_sink_describes_itself():
    sink = attached(device())
    questions = (
        c.decode(frame(0x2531, '0000 00')),
        frame(0x2502, '0000 0000'),
        frame(0x2505, '0000 0000'),
        frame(0x2504, '0000 0000 E8'),
        frame(0x2504, '0000 0000 07'),
        frame(0x2500, '78 56 34 12 00 4B 12 00 00 00'),
        frame(0x2501, '0000 00 00'),
    )
    told = []
    for k, question in enumerate(questions):
        at_once = asked(sink, line_bytes(question), 2.0 + k)
        assert [each.data if isinstance(each, Frame) else bytes((each.status,)) for each in at_once] == [b'\x00']
        told += sink.advance(2.5 + k)
    assert [f.header for f in told] == [0x45B1, 0x4582, 0x4585, 0x4584, 0x4584, 0x4580, 0x4581]
    assert told[1].data[:6] == bytes.fromhex('0000 00 0000 00')
    assert len(told[1].data) == 18
    assert told[2].data == bytes.fromhex('0000 00 0000 01 E8')
    assert told[3].data == bytes.fromhex('0000 00 0000 0A E8 01BF 0000 00 01 1000 00')
    assert told[4].data == bytes.fromhex('0000 82 0000 00')
    assert told[5].data == told[6].data == b'\x00' + IEEE.to_bytes(8, 'little') + bytes(4)


def test_motes_answer_and_strangers_do_not():
    sink = attached(device())
    sink.chip.motes[MOTE.short] = MOTE
    assert asked(sink, encode_frame(frame(0x2505, '3E14 3E14')), 2.0)[0].data == b'\x00'
    (active,) = sink.advance(3.0)
    assert active.data == bytes.fromhex('3E14 00 3E14 01 E8')
    asked(sink, encode_frame(frame(0x2505, '3F14 3F14')), 3.0)
    assert sink.advance(4.0) == []
    asked(sink, c.ZdoMgmtLqiReq(0, 0), 4.0)
    (neighbours,) = by_and_by(sink, 5.0)
    assert [n.short for n in neighbours.neighbours] == [MOTE.short]
    assert neighbours.neighbours[0].device_type == 'router'
    assert asked(sink, c.UtilGetDeviceInfo(), 5.0)[0].associated == (MOTE.short,)


def test_neighbours_come_in_parts():
    sink = attached(device())
    sink.chip.motes.update({k: Mote(k, k) for k in range(1, 6)})
    seen = []
    while len(seen) < 5:
        asked(sink, c.ZdoMgmtLqiReq(0, len(seen)), 2.0 + len(seen))
        (part,) = by_and_by(sink, 2.5 + len(seen))
        assert (part.total, part.start) == (5, len(seen))
        seen += [n.short for n in part.neighbours]
    assert seen == [1, 2, 3, 4, 5]


def test_message_to_the_profile_is_answered_as_the_message_that_it_is():
    sink = attached(device())
    data_of(sink, 0x253E, 'FFFF', 2.0)
    request = '02 0000000000000000 00 0000 01 0500 2A 00 1E 0300 2A 0000'
    assert data_of(sink, 0x2402, request.replace('00 0000 01', '00 0000 00'), 2.0) == b'\x00'
    told = sink.advance(3.0)
    assert [f.header for f in told] == [0x4585, 0x45FF]
    assert told[1].data == bytes.fromhex('0000 00 0580 00 2A 0000 00 0000 01 E8')


def test_small_print_of_the_descriptors():
    sink = attached(device())
    sink.chip.motes[MOTE.short] = MOTE
    mote_ieee = MOTE.ieee.to_bytes(8, 'little').hex()
    for k, (header, data, answer) in enumerate(
        (
            (0x2502, '3E14 3E14', '3e14 00 3e14 01408e'),
            (0x2502, '0000 3E14', '0000 81 3e14'),
            (0x2503, '0000 0000', '0000 00 0000 10c1'),
            (0x2503, '0000 3E14', '0000 81 3e14'),
            (0x2504, '0000 3E14 E8', '0000 81 3e14 00'),
            (0x2505, '0000 3E14', '0000 81 3e14 00'),
            (0x2506, '0000 0000 01BF 00 00', '0000 00 0000 01 e8'),
            (0x2506, '0000 0000 0401 00 00', '0000 00 0000 00'),
            (0x2500, mote_ieee + '00 00', '00' + mote_ieee + '3e14 0000'),
            (0x2501, '3E14 00 00', '00' + mote_ieee + '3e14 0000'),
            (0x2532, '0000 00', '0000 00 00 00 00'),
            (0x2533, '0000 00', '0000 00 00 00 00'),
            (0x2521, '0000 00', '0000 00'),
        )
    ):
        assert data_of(sink, header, data, 2.0 + k) == b'\x00'
        (told,) = sink.advance(2.5 + k)
        assert told.header == header + 0x2080
        assert told.data.hex().startswith(answer.replace(' ', '')), (header, told.data.hex())
    for k, (header, data) in enumerate(
        ((0x2501, '7777 00 00'), (0x2500, '00' * 10), (0x2504, '0000'), (0x2537, '0000'))
    ):
        sink.feed(encode_frame(frame(header, data)), 20.0 + k)
        assert sink.advance(20.5 + k) == []


def test_scan_and_joining_are_answered():
    sink = attached(device())
    assert data_of(sink, 0x2536, '02 0000 3C 01', 2.0) == b'\x00'
    told = sink.advance(3.0)
    assert [(f.header, f.data.hex()) for f in told] == [(0x45CB, '3c'), (0x45B6, '000000')]
    assert data_of(sink, 0x2537, '0000 02 00F8FF07 02 01 0000', 3.0) == b'\x00'
    (scan,) = sink.advance(4.0)
    assert (scan.header, len(scan.data)) == (0x45B8, 12 + 16)


def test_groups_are_kept():
    sink = attached(device())
    assert data_of(sink, 0x254A, 'E8 0100', 2.0)[0] == 1
    assert asked(sink, c.ZdoExtAddGroup(0xE8, 1), 2.0) == [c.ZdoExtAddGroupRsp(0)]
    assert data_of(sink, 0x254A, 'E8 0100', 2.0) == bytes.fromhex('00 0100 00')
    assert asked(sink, c.ZdoExtAddGroup(0x11, 1), 2.0) == [c.ZdoExtAddGroupRsp(1)]
    assert data_of(sink, 0x2547, 'E8 0100', 2.0) == b'\x00'


# ---- messages


def test_message_to_a_mote_is_confirmed_and_kept():
    sink = attached(device())
    sink.chip.motes[MOTE.short] = MOTE
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
def test_message_to_any_kind_of_address(mode_and_address, status, dst):
    sink = attached(device())
    sink.chip.motes[MOTE.short] = MOTE
    rest = 'E8 0000 E8 1000 07 00 1E 0300 616263'
    assert data_of(sink, 0x2402, mode_and_address + rest, 2.0) == b'\x00'
    assert by_and_by(sink, 3.0) == [c.AfDataConfirm(status, 0xE8, 7)]
    assert [(sent.dst, sent.data) for sent in sink.chip.sent] == ([(dst, b'abc')] if dst else [])
    assert data_of(sink, 0x2402, '07' + mode_and_address[2:] + rest, 4.0) == b'\x02'


def test_message_along_a_route():
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


def test_clock_of_the_sink_counts_320_us_and_wraps():
    sink = attached(device(first_tick=TICK_MODULUS - 10))
    times = [sink.chip.booted + 0.00032 * k + 1.1e-4 for k in (9, 10, 3125 + 10)]
    sink.chip.now = 0.0
    ticks = []
    for time_s in times:
        sink.chip.now = time_s
        ticks.append(sink.chip.ticks)
    assert ticks == [TICK_MODULUS - 1, 0, 3125]
    sink.reset(10.0)
    sink.advance(11.0)
    assert sink.chip.ticks == 3125


def test_timers_expire():
    sink = device()
    assert data_of(sink, 0x210A, '02 E803') == b'\x00'
    assert sink.advance(0.99) == []
    assert sink.advance(1.01) == [frame(0x4181, '02')]
    assert data_of(sink, 0x210A, '04 E803', 1.1) == b'\x02'


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
def test_small_questions(header, data, answer):
    assert data_of(device(), header, data).hex() == answer


def test_address_can_be_set_until_the_memory_is_cleared():
    sink = device()
    assert data_of(sink, 0x2103, '0102030405060708') == b'\x00'
    assert data_of(sink, 0x2104) == bytes.fromhex('0102030405060708')
    asked(sink, c.NvWrite(3, 0, b'\x03'))
    asked(sink, encode_frame(frame(0x4609)))
    by_and_by(sink, 1.0)
    assert data_of(sink, 0x2104, now=1.0) == IEEE.to_bytes(8, 'little')


# ---- any input


def test_reader_is_deaf_after_a_stray_byte_until_it_is_woken():
    reader = FirmwareReader()
    ping = BYTES['SYS_PING_SREQ']
    assert reader.feed(b'\xfe\xf0' + ping * 10) == []
    assert reader.feed(b'\xef' * 256) == []
    assert [f.header for f in reader.feed(ping)] == [0x2101]


@properties
@given(st.binary(max_size=300))
def test_256_bytes_ef_wake_it_after_anything(noise):
    sink = device()
    sink.feed(noise, 0.0)
    sink.feed(b'\xef' * 256, 0.0)
    sink.advance(10.0)
    assert asked(sink, c.SysPing(), 10.0) == [c.SysPingRsp(0x0179)]


@properties
@given(
    st.sampled_from(['home_1_2', 'zstack_3_0']),
    st.lists(st.tuples(st.integers(0, 0xFFFF), st.binary(max_size=60)), max_size=20),
    st.booleans(),
)
def test_any_command_is_answered_once_or_not_at_all(flavour, commands, up):
    sink = device(flavour, up=up)
    for k, (header, data) in enumerate(commands):
        request = Frame(header, data)
        answers = sink.answer(request, float(k))
        if request.kind == Kind.SREQ:
            (answer,) = answers
            refused = answer.header == 0x6000 and answer.data[1:] == bytes((header >> 8, header & 0xFF))
            assert refused or answer.header == header + 0x4000
        else:
            assert answers == []
        for said in [*answers, *sink.advance(k + 0.5)]:
            assert parse(encode_frame(said)) == [said]


KNOWN = [
    *(0x2100 + k for k in (1, 2, 3, 4, 7, 8, 9, 0x0A, 0x0C, 0x0F, 0x12, 0x13, 0x14, 0x1C, 0x1D)),
    *(0x2400 + k for k in (0, 1, 2, 3, 4, 0x10)),
    *(0x2500 + k for k in (0, 1, 2, 3, 4, 5, 6, 0x21, 0x22, 0x31, 0x32, 0x33, 0x36, 0x37, 0x3E, 0x3F, 0x40)),
    *(0x2500 + k for k in (0x45, 0x46, 0x47, 0x4A, 0x4B, 0x50)),
    *(0x2700 + k for k in (0, 6, 9, 0x0A, 0x48, 0x49, 0x4A)),
    *(0x2600 + k for k in (4, 5, 8)),
    *(0x2F00 + k for k in (1, 2, 3, 4, 5, 6, 7, 8, 9, 0xFF)),
    0x4100,
    0x4609,
]


@properties
@given(
    st.sampled_from(['home_1_2', 'zstack_3_0']),
    st.lists(st.tuples(st.sampled_from(KNOWN), st.binary(max_size=40)), max_size=30),
)
def test_known_commands_with_any_data_never_raise(flavour, commands):
    sink = attached(device(flavour))
    now = 1.0
    for header, data in commands:
        said = sink.answer(Frame(header, data), now)
        assert len(said) == (header < 0x4000)
        now += 0.05
        assert all(len(f.data) <= 250 for f in sink.advance(now))
    sink.feed(b'\xef' * 256, now)
    assert asked(sink, c.SysPing(), now + 300.0)[-1].capabilities in {0x0179, 0x0659}
