import random
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from zstack_cases import BYTES, is_subsequence, line_bytes, message, parse, properties, report_payload

from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.commands import AfRegisterRsp, decode
from wsn_tracking.zstack.frames import Frame, encode_frame, fcs
from wsn_tracking.zstack.parser import GAP_S, MAX_HELD, Parser

STREAM = b''.join(BYTES.values())
FRAMES = [frame for data in BYTES.values() for frame in parse(data)]
REPORTS = [line_bytes(message(report_payload(seq=seq, rssi=-40 - seq), ticks=1000 * seq)) for seq in range(6)]
GROWN = [
    frame._replace(data=frame.data + bytes(range(1, 1 + more)))
    for name in ('SYS_PING_SRSP_cc2531', 'SYS_RESET_IND', 'ZDO_STATE_8', 'UTIL_DEVINFO_SRSP', 'AF_IN_1', 'MGMT_LQI_RSP')
    for frame in parse(BYTES[name])
    for more in (1, 2, 5, 16)
]
garbage = st.one_of(
    st.binary(max_size=40),
    st.lists(st.sampled_from([0xFE, 0xFA, 0xFF, 0x44, 0x81, 0x00, 0x2A, 0x61, 0x02]), max_size=40).map(bytes),
    st.sampled_from([b'boot\r\n', b'\xfe', b'\xfe\xfe\xfe', b'\xfe\xfa', b'\xfe\x2a\x44\x81', bytes(300)]),
)


def valid_at(stream, at):
    """Written without the parser: do the bytes there make a frame?"""
    if at + 5 > len(stream) or stream[at] != 0xFE or stream[at + 1] > 250:
        return False
    stop = at + stream[at + 1] + 5
    return stop <= len(stream) and fcs(stream[at + 1 : stop]) == 0


@properties
@given(st.lists(st.integers(0, len(STREAM)), max_size=30))
def test_frames_do_not_depend_on_how_the_stream_is_split(cuts):
    parser, frames = Parser(), []
    edges = [0, *sorted(cuts), len(STREAM)]
    for a, b in pairwise(edges):
        frames += parser.feed(STREAM[a:b], 0.0)
    assert frames == FRAMES
    assert parser.held == 0


@properties
@given(
    st.lists(st.one_of(garbage, st.sampled_from([*BYTES.values(), *REPORTS, *map(line_bytes, GROWN)])), max_size=12),
    st.data(),
)
def test_any_stream_gives_the_same_frames_however_it_is_split(pieces, data):
    """Broken frames, noise and sound frames: what is found, and what is counted, is a matter of the bytes alone."""
    stream = b''.join(pieces)
    cuts = data.draw(st.lists(st.integers(0, len(stream)), max_size=30))
    whole, split, frames = Parser(), Parser(), []
    for a, b in pairwise([0, *sorted(cuts), len(stream)]):
        frames += split.feed(stream[a:b], 0.0)
    assert [*frames, *split.flush()] == [*whole.feed(stream, 0.0), *whole.flush()]
    assert split.counters == whole.counters


def test_frames_come_byte_by_byte():
    parser = Parser()
    assert [frame for i in range(len(STREAM)) for frame in parser.feed(STREAM[i : i + 1], 0.001 * i)] == FRAMES
    assert parser.counters['garbage_bytes'] == 0


@properties
@given(st.lists(st.tuples(garbage, st.sampled_from(list(BYTES.values()))), min_size=1, max_size=8), garbage)
def test_garbage_without_a_frame_in_it_loses_no_frame(pieces, tail):
    stream, frames, mine = b'', [], []
    for noise, data in pieces:
        mine += range(len(stream), len(stream) + len(noise))
        stream += noise + data
        frames += parse(data)
    mine += range(len(stream), len(stream) + len(tail))
    stream += tail
    assume(not any(valid_at(stream, at) for at in mine))
    assert parse(stream) == frames


def corruptions(stream):
    draw = random.Random(5)
    for at in range(len(stream)):
        for value in {0x00, 0xFE, 0xFF, 0xFA, stream[at] ^ 1, stream[at] ^ 0x80, draw.randrange(256)} - {stream[at]}:
            yield at, stream[:at] + bytes((value,)) + stream[at + 1 :]


@pytest.mark.parametrize('pieces', [list(BYTES.values()), REPORTS], ids=['captured', 'reports'])
def test_single_corrupted_byte_loses_at_most_its_frame(pieces):
    frames = [frame for data in pieces for frame in parse(data)]
    owner = [i for i, data in enumerate(pieces) for _ in data]
    for at, stream in corruptions(b''.join(pieces)):
        others = [frame for i, frame in enumerate(frames) if i != owner[at]]
        assert is_subsequence(others, parse(stream)), f'byte {at}'


def test_every_corruption_of_every_byte_of_a_report_loses_that_report_alone():
    """All 255 of each byte; the reports behind it are there at once, or when the line has paused for a gap."""
    sound = [parse(data)[0] for data in REPORTS[:4]]
    before, struck, *behind = REPORTS[:4]
    for at in range(len(struck)):
        for value in set(range(256)) - {struck[at]}:
            parser = Parser()
            stream = before + struck[:at] + bytes((value,)) + struck[at + 1 :] + b''.join(behind)
            found = [*parser.feed(stream, 0.0), *parser.feed(b'', 1.01 * GAP_S)]
            assert found[:1] + found[-2:] == [sound[0], *sound[2:]], (at, value)
            assert len(found) <= 4, (at, value)


@pytest.mark.parametrize('length', range(256))
def test_corrupted_length_delays_nothing(length):
    """The frames behind it come as soon as they are complete, not when as many bytes have come as it promised."""
    broken = REPORTS[0][:1] + bytes((length,)) + REPORTS[0][2:]
    parser = Parser()
    parser.feed(broken, 0.0)
    for data in REPORTS[1:]:
        assert parser.feed(data, 0.0)[-1:] == parse(data)


def test_stray_start_byte_swallows_nothing():
    parser = Parser()
    parser.feed(b'\xfe', 0.0)
    assert [frame for data in REPORTS for frame in parser.feed(data, 0.0)] == [parse(data)[0] for data in REPORTS]


def test_stray_beginning_swallows_nothing_though_its_check_is_right_by_chance():
    """With what follows it makes a frame of no known command, in which a frame begins that goes on behind its end."""
    stray = b'\xfe\x0f\x44'
    reports = [line_bytes(message(report_payload(), ticks=256 * k)) for k in range(256)]
    (struck,) = (data for data in reports if valid_at(stray + data, 0))
    parser = Parser()
    assert parser.feed(REPORTS[0] + stray + struck, 0.0) == [*parse(REPORTS[0]), *parse(struck)]


def test_length_above_250_is_no_frame():
    parser = Parser()
    body = bytes((251, 0x44, 0x00)) + bytes(251)
    assert parser.feed(b'\xfe' + body + bytes((fcs(body),)), 0.0) == []
    assert parser.held == 0
    assert parser.counters['bad_length'] >= 1


@pytest.mark.parametrize('kept', range(1, len(REPORTS[0])))
def test_pause_ends_a_broken_frame_at_every_byte(kept):
    parser = Parser(gap_s=0.1)
    assert parser.feed(REPORTS[0][:kept], 5.0) == []
    assert parser.feed(REPORTS[1], 5.11) == parse(REPORTS[1])
    assert parser.counters['gaps'] == 1


@pytest.mark.parametrize('grown', GROWN, ids=lambda frame: f'{frame.header:04X}+{len(frame.data)}')
def test_frame_that_has_grown_with_the_firmware_counts_at_once(grown):
    """However it is split, and what the command is known to hold is read from it."""
    stream = line_bytes(grown)
    for step in (1, 7, 300):
        parser, frames = Parser(), []
        for at in range(0, len(stream) + len(REPORTS[0]), step):
            frames += parser.feed((stream + REPORTS[0])[at : at + step], 0.0)
        assert frames == [grown, *parse(REPORTS[0])]
    assert Parser().feed(stream, 0.0) == [grown]
    assert not isinstance(decode(grown), Bad)


def test_frame_that_seems_to_have_grown_swallows_nothing():
    """LEN is larger by 5 and the FCS happens to fit: the frame within the claimed length tells the truth."""
    short = line_bytes(AfRegisterRsp(0))
    body = bytes((len(short) + 1, 0x45, 0xC0, 9)) + short  # a ZDO_STATE_CHANGE_IND of 7 bytes that holds a frame
    stream = b'\xfe' + body + bytes((fcs(body),))
    assert parse(stream + REPORTS[0]) == [*parse(short), *parse(REPORTS[0])]


def test_shorter_pause_ends_nothing():
    parser = Parser(gap_s=0.1)
    parser.feed(REPORTS[0][:20], 5.0)
    parser.feed(REPORTS[0][20:21], 5.09)
    assert parser.feed(REPORTS[0][21:], 5.18) == parse(REPORTS[0])


UNKNOWN = b'\xfe\xfa\x41\x99'  # the beginning of a frame that no table knows


def test_time_alone_ends_a_broken_frame_and_frees_what_it_swallowed():
    parser = Parser(gap_s=0.1)
    begun = parser.feed(UNKNOWN + REPORTS[0][:-1], 1.0)
    assert (begun, parser.feed(b'', 1.05)) == ([], [])
    assert parser.held == 3 + len(REPORTS[0])
    assert parser.feed(REPORTS[0][-1:] + REPORTS[1], 1.2) == [*parse(REPORTS[1])]
    assert parser.held == 0


def test_frame_within_one_of_no_known_command_comes_at_once():
    """The larger one was none: its beginning is noise, or was damaged."""
    parser = Parser(gap_s=0.1)
    assert parser.feed(UNKNOWN + REPORTS[0] + REPORTS[1], 1.0) == [*parse(REPORTS[0]), *parse(REPORTS[1])]
    body = bytes((len(REPORTS[0]), 0x45, 0xCF)) + REPORTS[0]
    assert parser.feed(b'\xfe' + body + bytes((fcs(body),)), 1.01)[0] == parse(REPORTS[0])[0]


def test_frame_of_no_known_command_is_one():
    """Of any length, whatever its data look like that are no sound frame of a known command."""
    frames = [Frame(0x45CF), Frame(0x4555, b'\xfe' * 250), Frame(0x6D08, REPORTS[0][:-1])]
    assert parse(b''.join(map(line_bytes, frames)) + REPORTS[0]) == [*frames, *parse(REPORTS[0])]


def test_ten_million_random_bytes_do_no_harm():
    draw, parser, found = random.Random(7), Parser(), 0
    for _ in range(100):
        data = draw.randbytes(100_000)
        for at in range(0, len(data), 10_000):
            for frame in parser.feed(data[at : at + 10_000], 0.0):
                decode(frame)
                assert encode_frame(frame)[-1] < 256
                found += 1
            assert parser.held <= MAX_HELD
    assert 0 < found == parser.counters['frames']


@properties
@given(st.binary(max_size=2000), st.integers(1, 50))
def test_every_byte_is_accounted_for(data, step):
    parser, frames = Parser(), []
    for at in range(0, len(data), step):
        frames += parser.feed(data[at : at + step], 0.0)
        assert parser.held <= MAX_HELD
    used = sum(len(encode_frame(frame)) for frame in frames)
    assert used + parser.counters['garbage_bytes'] + parser.held == len(data)
    assert parser.counters['frames'] == len(frames)
