"""Whatever a host says, the simulated firmware answers once or not at all, and can be woken."""

from hypothesis import given
from hypothesis import strategies as st
from sink_cases import asked, attached, device
from zstack_cases import BYTES, parse, properties

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.firmware.reader import FirmwareReader
from wsn_tracking.zstack.frames import Frame, Kind, encode_frame


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
