"""Frames whose data are full of FE: where one byte is damaged, candidates that overlap are told apart."""

import random
from itertools import pairwise

import pytest
from zstack_cases import is_subsequence, line_bytes, message, parse, report_payload

from wsn_tracking.zstack.commands import AfDataConfirm, MtAppRsp, SysResetInd, ZdoStateChangeInd, encode
from wsn_tracking.zstack.frames import OVERHEAD, SOF, Frame, encode_frame, fcs
from wsn_tracking.zstack.parser import GAP_S, MAX_HELD, Parser
from wsn_tracking.zstack.payload import encode_payload

UNKNOWN = (0x4482, 0x45CB, 0x45FF, 0x6D08, 0x5507)
HEADER_BYTES = (0x44, 0x81, 0x45, 0xC0, 0x61, 0x69, 0x80, 0x01, 0x02, 0x05, 0x41)


def data_full_of_fe(draw, size):
    """Half of it FE, the rest what headers are made of, lengths, and anything."""
    return bytes(
        draw.choice((SOF, SOF, SOF, draw.randrange(64), draw.choice(HEADER_BYTES), draw.randrange(256)))
        for _ in range(size)
    )


def frame_of(draw, kind):
    data = data_full_of_fe(draw, draw.choice((7, 22, 22, 30, 62)))
    if kind == 'mixed':
        kind = draw.choice(('af', 'af', 'app', 'unknown', 'short'))
    if kind == 'af':
        return encode(message(data))
    if kind == 'app':
        return encode(MtAppRsp(0xE8, data))
    if kind == 'unknown':
        return Frame(draw.choice(UNKNOWN), data)
    return encode(draw.choice((ZdoStateChangeInd(9), SysResetInd(0, 2, 0, 2, 6, 3), AfDataConfirm(0, 0xE8, 1))))


@pytest.mark.parametrize('kind', ['af', 'app', 'unknown', 'mixed'])
def test_damaged_byte_between_data_full_of_fe_loses_its_frame_alone(kind):
    """Every byte of a frame, four values each, some ten thousand streams of bytes.

    A second frame can still be lost: where a false one ends at the very byte at which a sound one ends, and the check
    of the false one is right by chance, both readings of the stream are as good.
    """
    draw, tried = random.Random(f'FE {kind}'), 0
    while tried < 8000:
        frames = [frame_of(draw, kind) for _ in range(4)]
        pieces = [encode_frame(frame) for frame in frames]
        begin = len(pieces[0])
        for at in range(begin, begin + len(pieces[1])):
            stream = b''.join(pieces)
            for value in {SOF, 0, stream[at] ^ 1, draw.randrange(256)} - {stream[at]}:
                tried += 1
                found = parse(stream[:at] + bytes((value,)) + stream[at + 1 :])
                assert is_subsequence([frames[0], *frames[2:]], found), (stream.hex(), at, value)


@pytest.mark.parametrize('name', ['ours', 'of another application', 'unknown'])
def test_any_damaged_length_loses_its_frame_alone(name):
    """The shapes of these commands set LEN no bounds."""
    draw = random.Random(name)
    for seq in range(20):
        payload = encode_payload(report_payload(seq=seq, rssi=-40 - seq))
        frames = [
            Frame(0x45CB, payload)
            if name == 'unknown'
            else encode(MtAppRsp(0xE8, payload if name == 'ours' else draw.randbytes(12 + seq)))
            for _ in range(12)
        ]
        pieces = [encode_frame(frame) for frame in frames]
        for length in range(256):
            if length == pieces[1][1]:
                continue
            damaged = pieces[1][:1] + bytes((length,)) + pieces[1][2:]
            found = parse(b''.join((pieces[0], damaged, *pieces[2:])))
            assert is_subsequence([frames[0], *frames[2:]], found), (seq, length)


def test_what_overlaps_does_not_depend_on_how_the_stream_is_split():
    draw = random.Random('split')
    for _ in range(150):
        stream = bytearray(b''.join(encode_frame(frame_of(draw, 'mixed')) for _ in range(5)))
        for _ in range(draw.randrange(4)):
            stream[draw.randrange(len(stream))] = draw.choice((SOF, draw.randrange(256)))
        whole, split, frames = Parser(), Parser(), []
        cuts = sorted(draw.randrange(len(stream)) for _ in range(draw.choice((3, 30, len(stream)))))
        for a, b in pairwise([0, *cuts, len(stream)]):
            frames += split.feed(bytes(stream[a:b]), 0.0)
            assert split.held <= MAX_HELD
        assert [*frames, *split.flush()] == [*whole.feed(bytes(stream), 0.0), *whole.flush()]
        assert split.counters == whole.counters


BEGUN = bytes((SOF, 29, 0x45, 0xCB)) + bytes(18)  # the beginning of a frame of no known command


def test_message_that_holds_the_beginning_of_a_frame_comes_at_once():
    """Also behind noise: its LEN fits, which hardly ever happens by chance."""
    stream = line_bytes(message(BEGUN))
    for before in (b'', stream, b'noise'):
        assert Parser().feed(before + stream, 0.0)[-1:] == parse(stream)


def test_unknown_frame_that_holds_the_beginning_of_another_is_waited_for_behind_noise_alone():
    """Until it is followed, or the line pauses."""
    stream = line_bytes(Frame(0x45FF, BEGUN))
    frame = parse(stream)
    assert Parser().feed(stream, 0.0) == frame
    for following in (stream, line_bytes(ZdoStateChangeInd(9))):
        parser = Parser()
        assert parser.feed(b'noise' + stream, 0.0) == []
        assert parser.feed(following, 0.01)[:1] == frame
    parser = Parser()
    assert parser.feed(b'noise' + stream, 0.0) == []
    assert parser.feed(b'', 1.01 * GAP_S) == frame


def damaged_before(sound):
    """A damaged message, in which a frame of no known command begins that goes on into `sound`, its check right."""
    head = bytes((SOF, 32, 0x45, 0xCB))
    damaged = line_bytes(message(head + bytes(8)))
    begun = damaged[damaged.index(head) :]
    wrong = fcs(begun[1:] + sound[: 32 + OVERHEAD - len(begun)])
    return damaged[:-2] + bytes((damaged[-2] ^ wrong, damaged[-1]))


def test_of_two_frames_that_overlap_the_one_whose_length_fits_is_true():
    sound = line_bytes(message(report_payload()))
    assert Parser().feed(damaged_before(sound) + sound, 0.0) == parse(sound)


def test_of_two_unknown_frames_that_overlap_the_one_that_is_followed_is_true():
    sound, behind = line_bytes(Frame(0x4482, bytes(40))), line_bytes(message(report_payload()))
    damaged = damaged_before(sound)
    assert parse(damaged + sound) == parse(sound)
    parser = Parser()
    assert parser.feed(damaged + sound, 0.0) == []
    assert parser.feed(behind, 0.01) == [*parse(sound), *parse(behind)]


def test_grown_frame_that_holds_a_start_byte_counts_when_the_line_pauses_or_another_follows():
    grown = Frame(0x45C0, bytes((9, 1, 2, SOF)))
    assert Parser().feed(line_bytes(grown) * 2, 0.0)[0] == grown
    assert parse(line_bytes(grown)) == [grown]
