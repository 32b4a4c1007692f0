"""The network of the simulated firmware is remembered, restored, formed, and forgotten at a reset."""

from sink_cases import BOTH, REGISTER, asked, attached, by_and_by, device

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.device import DEFAULT_NETWORK, IEEE
from wsn_tracking.zstack.firmware.chip import TICK_MODULUS
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.parser import Parser


@BOTH
def test_network_that_is_remembered_is_restored(flavour):
    sink = device(flavour)
    assert asked(sink, c.UtilGetDeviceInfo())[0].state == 0
    assert asked(sink, c.ZdoStartup(100)) == [c.ZdoStartupRsp(0)]
    assert by_and_by(sink, 1.0) == [c.ZdoStateChangeInd(9)]
    info = asked(sink, c.ZdoExtNwkInfo(), 1.0)[0]
    assert (info.state, info.pan_id, info.channel, info.ext_pan) == (9, 0x1A62, 11, DEFAULT_NETWORK.ext_pan)


@BOTH
def test_network_is_started_by_a_delay_of_one_byte_too(flavour):
    """As some hosts give it; whoever looks at the line sees that."""
    question = Frame(0x2540, b'\x00')
    sink = device(flavour)
    assert sink.answer(question, 0.0) == [c.encode(c.ZdoStartupRsp(0))]
    assert by_and_by(sink, 1.0) == [c.ZdoStateChangeInd(9)]
    assert Parser().feed(encode_frame(question), 0.0) == [question]


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
