import contextlib
import os
import time
import tty

import pytest
from zstack_cases import line_bytes, message, report_payload

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack import port as port_module
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.line import Bell, Line
from wsn_tracking.zstack.port import open_port, ports
from wsn_tracking.zstack.protocols import Radio, protocol_of

SOON = 20.0
DATA = line_bytes(message(report_payload()))


@pytest.fixture
def pty():
    master, slave = os.openpty()
    tty.setraw(slave)
    yield master, os.ttyname(slave)
    for fd in (master, slave):
        with contextlib.suppress(OSError):
            os.close(fd)


@pytest.fixture
def port(pty):
    with contextlib.closing(open_port(pty[1], 115200, 0.2)) as opened:
        yield opened


def hear(line):
    return line.hear(time.monotonic() + SOON).items


def test_time_in_which_the_host_was_held_up_is_no_pause_of_the_line(pty, port):
    """The gap is a microsecond: far less than passes between the two halves, but nobody looked at an empty line."""
    line = Line(port, protocol_of('znp', Radio(), gap_s=1e-6), 1e-6)
    os.write(pty[0], DATA[:20])
    assert hear(line) == []
    os.write(pty[0], DATA[20:])
    assert len(hear(line)) == 1


def test_pause_that_was_watched_ends_a_frame(pty, port):
    protocol = protocol_of('znp', Radio(), gap_s=0.01)
    line = Line(port, protocol, 0.01)
    broken_off, whole = b'\xfe\xfa\x41\x99', line_bytes(Frame(0x4555, b'\x01'))  # both of no known command
    os.write(pty[0], broken_off + whole)
    items = []
    while not items:
        items = hear(line)
    assert len(items) == 1
    assert protocol.counters['gaps'] == 1


def test_bell_wakes_before_and_while_the_line_is_waited_for(port):
    bell = Bell()
    with contextlib.closing(bell):
        line = Line(port, protocol_of('znp', Radio()), 0.1, bell)
        bell.ring()
        assert hear(line) == []  # at once: the test would take SOON otherwise
        for _ in range(100_000):
            bell.ring()  # it never blocks
        assert hear(line) == []
        began = time.monotonic()
        line.hear(began + 0.02)
        assert time.monotonic() - began >= 0.02  # it does not ring on


def test_what_is_said_arrives(pty, port):
    Line(port, protocol_of('znp', Radio()), 0.1).say(c.SysPing())
    assert os.read(pty[0], 100) == bytes.fromhex('FE 00 21 01 20')


def test_drop_counts_what_it_discards(pty, port):
    line = Line(port, protocol_of('znp', Radio()), 0.1)
    os.write(pty[0], DATA + DATA[:7])
    assert line.drop() == len(DATA) + 7
    assert line.drop() == 0


def test_line_that_takes_nothing_fails_and_names_flow_control(port):
    with pytest.raises(TrackingError, match='rtscts'):
        port.write(bytes(1 << 20))


def test_lost_line_fails_when_read_and_written(pty, port):
    os.close(pty[0])
    with pytest.raises(TrackingError, match=r'cannot be read \(it was hung up\): still plugged in'):
        port.read()
    with pytest.raises(TrackingError, match='cannot be written to'):
        port.write(b'x')


def test_missing_port_is_said_with_those_that_there_are(tmp_path, monkeypatch):
    monkeypatch.setattr(port_module, 'ports', lambda: ['/dev/ttyACM7'])
    with pytest.raises(TrackingError, match=r'no such port: .*absent; serial ports here: /dev/ttyACM7'):
        open_port(str(tmp_path / 'absent'), 115200, 1.0)


def test_ports_are_found_by_their_lasting_names_first(tmp_path, monkeypatch):
    (tmp_path / 'serial/by-id').mkdir(parents=True)
    for name in ('ttyUSB1', 'ttyACM0', 'ttyS0', 'serial/by-id/usb-TI_CC2531'):
        (tmp_path / name).touch()
    monkeypatch.setattr(port_module, 'DEV', tmp_path)
    assert ports() == [str(tmp_path / name) for name in ('serial/by-id/usb-TI_CC2531', 'ttyACM0', 'ttyUSB1')]


@pytest.mark.parametrize(
    ('number', 'words'), [(13, 'sudo usermod -aG dialout'), (16, 'in use by another program'), (5, 'expected a tty')]
)
def test_error_of_opening_says_what_to_do(monkeypatch, number, words):
    def refuse(*arguments, **more):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(port_module.serial, 'Serial', refuse)
    with pytest.raises(TrackingError, match=words):
        open_port('/dev/ttyACM0', 115200, 1.0)


def test_file_that_is_no_port_is_refused(tmp_path):
    (tmp_path / 'file').write_bytes(b'x')
    with pytest.raises(TrackingError, match='expected a tty'):
        open_port(str(tmp_path / 'file'), 115200, 1.0)
