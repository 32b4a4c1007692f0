"""What a simulated sink and its motes say of themselves."""

from sink_cases import MOTE, asked, attached, by_and_by, data_of, device, frame, joined
from zstack_cases import line_bytes

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.device import IEEE
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.frames import Frame, encode_frame


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
    sink = joined()
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


def test_every_request_for_a_descriptor_is_answered_in_its_kind():
    sink = joined()
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
