import contextlib
import os
import re
import threading

import pytest
from fake_sink import FakeSink, script
from zstack_cases import BYTES, VECTORS, line_bytes, message, report_payload

from wsn_tracking.cli import main
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.capture import MAX_BYTES, is_capture, read_capture
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.lqi import SCALES, lqi_of
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.records import FeedbackRecord, RangeRecord, SensingRecord
from wsn_tracking.zstack.reports import Report

QUICK = ('--set', 'timeout.settle=0.0', '--set', 'timeout.reply=0.3', '--set', 'timeout.wake=0.01')


def run(capsys, *arguments):
    """Exit code, output, error output."""
    with pytest.raises(SystemExit) as ended:
        main(['sink', *map(str, arguments)])
    said = capsys.readouterr()
    return ended.value.code, said.out, said.err


@pytest.fixture
def capture(tmp_path):
    def write(data, name='captured.bin'):
        (tmp_path / name).write_bytes(data)
        return tmp_path / name

    return write


@pytest.fixture
def sink(tmp_path):
    with contextlib.closing(FakeSink(tmp_path / 'sink')) as fake:
        yield fake


def test_dump_shows_every_captured_frame(capsys, capture):
    code, out, err = run(capsys, 'dump', capture(b'noise' + b''.join(BYTES.values())), '--hex')
    assert (code, err) == (0, '')
    lines = out.splitlines()
    assert [line.strip() for line in lines[1:-1:2]] == [row['hex'] for row in VECTORS.values()]
    assert lines[-1] == f'frames {len(VECTORS)}, garbage bytes 5'
    assert (
        'RSSI report node 3 seq 1 t 1000 ms; event triggered; 3000 mV; 1: -60 +- 0.5 dBm n 5 age 7 ms beacon 9' in out
    )
    assert 'SRSP SYS_VERSION Z-Stack Home 1.2 (2.6.3 revision 20190425)' in out
    assert 'SRSP RPC_ERROR code=1 cmd0=CD cmd1=AB' in out


@pytest.mark.parametrize(
    'text',
    [
        'FE 00 21 01 20\nFE 02 61 01 79 01 1A',
        '0xFE,0x00,0x21,0x01,0x20',
        'fe00210120',
        '\N{ZERO WIDTH NO-BREAK SPACE}FE-00-21-01-20  # a ping\r\n',
        'FE 00 21 01 20 FE 0',
    ],
)
def test_capture_may_be_written_in_hexadecimal(capsys, capture, text):
    _, out, _ = run(capsys, 'dump', capture(text.encode()))
    assert 'SREQ SYS_PING' in out
    assert read_capture(str(capture(text.encode())))[:5] == bytes.fromhex('FE 00 21 01 20')


def test_capture_of_lines_is_shown(capsys, capture):
    report = Report(report_payload(), lqi=105, hops=1)
    code, out, _ = run(capsys, 'dump', capture(b'boot\r\n' + encode_line(report) * 2), '--protocol', 'ascii', '--hex')
    assert code == 0
    assert out.count('$WSN RSSI report node 3 seq 1') == 2
    assert 'lines 2, garbage bytes 4' in out
    assert '24 57 53 4E' in out


def test_payloads_of_all_types_are_shown(capsys, capture):
    payloads = [
        report_payload(),
        Payload(PayloadType.HEARTBEAT, 3, 2, 2000, flags=4),
        Payload(PayloadType.RANGE, 3, 3, 3000, (RangeRecord(1, None, 2500, 20, 9),)),
        report_payload()._replace(type=PayloadType.WORN),
    ]
    _, out, _ = run(capsys, 'dump', capture(b''.join(line_bytes(message(payload)) for payload in payloads)))
    assert re.findall(r'RSSI report|heartbeat|range report|worn-node report', out) == [
        'RSSI report',
        'heartbeat',
        'range report',
        'worn-node report',
    ]
    assert '2500 +- 20 mm age ? ms beacon 9' in out
    assert 'battery low' in out


def test_messages_to_nodes_are_shown(capsys, capture):
    records = (FeedbackRecord(1, 0.5, -0.25, 0.1, 0.0),), (SensingRecord(3, 0, -90, 0.2, 2.0),)
    kinds = PayloadType.FEEDBACK, PayloadType.COMMAND
    data = [encode_payload(Payload(kind, 0, 1, 0, record)) for kind, record in zip(kinds, records, strict=True)]
    requests = [c.AfDataRequest(0x143E, 0xE8, 0xE8, 0x10, 1, 0, 30, payload) for payload in data]
    _, out, _ = run(capsys, 'dump', capture(b''.join(map(line_bytes, requests))))
    assert '1: (0.50, -0.25) m (0.10, 0.00) m/s' in out
    assert '3: rest, y_min -90 dBm, e 0.20 to 2.00 dB' in out


def test_unknown_and_foreign_frames_are_shown_as_such(capsys, capture):
    stream = BYTES['AF_IN_1'] + line_bytes(Frame(0x4555, b'\x01')) + line_bytes(Frame(0x4100))
    _, out, _ = run(capsys, 'dump', capture(stream))
    assert '[foreign_endpoint: endpoint 0x01]' in out
    assert 'AREQ 4555 [unknown_command: 4555]' in out


def test_probe_of_a_capture_sums_it_up(capsys, capture):
    lqis = [lqi_of(rssi, SCALES['cc26x2']) for rssi in range(-80, -40)]
    names = ('SYS_VERSION_5', 'SYS_PING_SRSP_cc2531', 'UTIL_DEVINFO_SRSP', 'AF_IN_1')
    stream = b''.join(BYTES[name] for name in names)
    stream += line_bytes(c.ZdoExtNwkInfoRsp(0, 9, 0x1A62, 0, 0xABCD, 0, 15))
    stream += b''.join(line_bytes(message(report_payload(seq=lqi), lqi=lqi)) for lqi in lqis)
    path = capture(stream)
    code, out, _ = run(capsys, 'probe', path)
    assert code == 0
    for words in (
        'firmware  Z-Stack Home 1.2 (2.6.3)',
        'offers    SYS AF ZDO SAPI UTIL APP',
        'device    0x00124b00199decc9, address 0x0000, state 9 (coordinator, network up)',
        'network   channel 15, PAN 0x1a62, extended PAN 0x000000000000abcd',
        'reports   40 x RSSI report, of nodes 3',
        'LQI       41 seen, scale cc2530 cannot give',
        'rejected  foreign_endpoint 1',
    ):
        assert words in out
    _, fitting, _ = run(capsys, 'probe', capture(b''.join(line_bytes(message(report_payload(), lqi=n)) for n in lqis)))
    assert 'set lqi_scale to cc26x2' in fitting
    _, right, _ = run(capsys, 'probe', path.parent / 'captured.bin', '--set', 'lqi_scale=cc26x2')
    assert '40 seen, all fit scale cc26x2' in right


@pytest.mark.parametrize('what', ['probe', 'dump'])
@pytest.mark.parametrize('content', [b'', b'no frames here\n', bytes(range(200))])
def test_file_that_holds_nothing_of_a_sink_is_refused_in_one_line(capsys, capture, what, content):
    code, out, err = run(capsys, what, capture(content))
    assert (code, out) == (1, '')
    (line,) = err.splitlines()
    assert f'captured.bin ({len(content)} bytes)' in line
    assert 'expected what was captured' in line


def test_probe_of_a_live_sink_asks_and_changes_nothing(capsys, sink):
    sink.answers[c.ZdoMgmtLqiReq] = [c.ZdoMgmtLqiReqRsp(0), BYTES['MGMT_LQI_RSP']]
    sink.answers[c.AfRegister] = [c.AfRegisterRsp(0), message(report_payload())]
    code, out, err = run(capsys, 'probe', sink.link, '--seconds', '0.1', *QUICK)
    assert (code, err) == (0, '')
    assert 'network   channel 11' in out
    assert 'reports   1 x RSSI report' in out
    assert 'LQI       1 seen, all fit scale cc2530' in out  # those of neighbour tables are smoothed: of no scale
    assert not sink.questions((c.NvWrite, c.SysResetReq, c.ZdoStartup, c.BdbStartCommissioning))


def test_probe_does_not_start_a_network_that_is_down(capsys, sink):
    sink.answers = script(state=0)
    code, out, _ = run(capsys, 'probe', sink.link, '--seconds', '0.0', *QUICK)
    assert code == 0
    assert 'state 0 (not started)' in out
    assert not sink.questions((c.ZdoStartup, c.AfRegister))


def test_dump_of_a_live_sink_attaches_again_after_a_reset(capsys, sink):
    def talk():
        sink.wait_asked(c.ZdoExtNwkInfo, 1)
        sink.say(message(report_payload(seq=1)), c.SysResetInd(2, 2, 0, 2, 6, 3))
        sink.wait_asked(c.ZdoExtNwkInfo, 2)
        sink.say(message(report_payload(seq=2)))

    talker = threading.Thread(target=talk)
    talker.start()
    code, out, _ = run(capsys, 'dump', sink.link, '--seconds', '1', *QUICK)
    talker.join()
    assert code == 0
    assert len(sink.questions(c.AfRegister)) == 2
    assert 'seq 1' in out
    assert 'seq 2' in out


def test_sink_that_restarts_while_it_is_attached_to_is_attached_to_again(capsys, sink):
    def first_time(asked):
        first = len(sink.questions(c.AfRegister)) == 1
        return [c.SysResetInd(0, 2, 0, 2, 6, 3)] if first else [c.AfRegisterRsp(0), message(report_payload(seq=1))]

    sink.answers[c.AfRegister] = first_time
    code, out, _ = run(capsys, 'dump', sink.link, '--seconds', '0.1', *QUICK)
    assert (code, len(sink.questions(c.AfRegister))) == (0, 2)
    assert 'RSSI report node 3 seq 1' in out


def test_lines_of_a_live_sink_are_only_listened_to(capsys, sink):
    sink.answers = {}
    holder = os.open(sink.device, os.O_RDWR | os.O_NOCTTY)
    code, out, _ = run(capsys, 'dump', sink.link, '--protocol', 'ascii', '--seconds', '0.05', *QUICK)
    os.close(holder)
    assert (code, sink.asked) == (0, [])
    assert out.splitlines()[-1].startswith('lines 0')


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (('probe', '/dev/ttyABSENT'), 'no such port: /dev/ttyABSENT'),
        (('dump', '/dev/null'), 'cannot be opened as a serial port (Inappropriate ioctl for device)'),
        (('dump', '/dev/ttyABSENT', '--set', 'nonsense=1'), 'expected NAME=VALUE, NAME one of port'),
        (('dump', '/dev/ttyABSENT', '--baud', '1'), 'expected an integer >= 1200'),
    ],
)
def test_error_is_one_line(capsys, arguments, words):
    code, out, err = run(capsys, *arguments)
    assert (code, out, err.count('\n')) == (1, '', 1)
    assert words in err


def test_silent_sink_is_an_error_of_one_line(capsys, sink):
    sink.mute = True
    code, _, err = run(capsys, 'probe', sink.link, '--set', 'timeout.ping=0.02', *QUICK)
    assert (code, err.count('\n')) == (1, 1)
    assert 'nothing answers at' in err


def test_file_that_cannot_be_read_is_named(capsys):
    code, out, err = run(capsys, 'dump', '/proc/self/mem')
    assert (code, out) == (1, '')
    assert '/proc/self/mem cannot be read (Input/output error)' in err


def test_file_too_large_for_a_capture_is_refused(capsys, tmp_path):
    path = tmp_path / 'huge'
    with path.open('wb') as file:
        file.truncate(MAX_BYTES + 1)
    code, _, err = run(capsys, 'dump', path)
    assert code == 1
    assert 'expected a capture of at most' in err
    assert is_capture(str(path))
