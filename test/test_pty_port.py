"""The port of a simulated sink: a stable name before a pseudo terminal that changes."""

from __future__ import annotations

import contextlib
import os

import pytest

from radio import PATIENCE
from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.port import open_port
from wsn_tracking.zstack.pty_port import PtyPort


def test_link_stays_while_the_device_changes(link):
    port = PtyPort(link)
    port.plug()
    port.plug()
    first = port.device
    assert os.path.realpath(link) == first
    port.unplug(reserve=True)
    assert not link.is_symlink()
    port.plug()
    assert port.device != first
    assert os.path.realpath(link) == port.device
    port.unplug()
    assert not link.is_symlink()


def test_link_of_a_run_that_was_killed_is_replaced(link):
    link.symlink_to('/dev/pts/no_such')
    port = PtyPort(link)
    port.plug()
    assert os.path.realpath(link) == port.device
    port.unplug()


def test_link_that_another_sink_has_taken_over_is_left(link):
    one, other = PtyPort(link), PtyPort(link)
    one.plug()
    other.plug()
    one.unplug()
    assert os.path.realpath(link) == other.device
    other.unplug()


def test_files_are_not_replaced(link):
    link.write_text('precious')
    with pytest.raises(TrackingError, match='no symbolic link'):
        PtyPort(link).plug()
    assert link.read_text() == 'precious'
    with pytest.raises(TrackingError, match='cannot be linked'):
        PtyPort(link.parent / 'no' / 'sink').plug()


def test_bytes_pass_unchanged_both_ways(link):
    port = PtyPort(link)
    port.plug()
    every = bytes(range(256))
    with contextlib.closing(open_port(str(link), 115200, 1.0)) as near:
        near.write(every)
        port.wait(PATIENCE)
        assert port.read() == every
        assert port.write(every) == 256
        read = b''
        while len(read) < 256:
            read += near.read()
        assert read == every
    assert port.read() == b''
    port.unplug()


def test_line_that_nobody_reads_takes_no_more_and_is_no_error(link):
    port = PtyPort(link)
    port.plug()
    while port.write(bytes(1000)):
        pass
    assert port.write(b'x') == 0
    port.unplug()
