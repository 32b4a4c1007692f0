"""Ports that vanish, come back, are absent, stale, or in use."""

import contextlib
import dataclasses
import os

import pytest
from fake_sink import FakeSink
from session_cases import FAST, comes_through, data

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.port import open_port


def test_unplug_and_replug_under_another_name(sink, host):
    up = host()
    up.wait_up()
    sink.say(data(0))
    up.wait_seqs([0])
    keep = os.open(sink.device, os.O_RDWR | os.O_NOCTTY)  # so that the next one cannot get the same name
    try:
        first = sink.device
        sink.unplug()
        up.until(lambda: up.session.counters['open_failed'] >= 2)
        sink.plug()
    finally:
        os.close(keep)
    assert sink.device != first
    up.wait_up(2)
    sink.say(data(1))
    up.wait_seqs([0, 1])
    assert up.session.status.device == sink.device
    assert up.counted('lost') == 1


@pytest.mark.parametrize('words', [b'', b'\xfe', data(9)[:20]], ids=['silent', 'after a start byte', 'within a frame'])
def test_port_may_vanish_at_any_moment(sink, host, words):
    """Before the first question, and after each one until the link is up; then it comes back and all is well."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    for step in range(12):
        seen = len(sink.asked)
        sink.wait(lambda n=seen + step: len(sink.asked) >= n)
        if words:
            sink.say(words)
        sink.unplug()
        failed = up.counted('lost') + up.counted('open_failed')
        up.until(lambda n=failed: up.counted('lost') + up.counted('open_failed') > n)
        sink.plug()
    already = up.events('up')
    up.wait_up(already + 1)
    up.until(comes_through(up, sink, 3))
    assert up.counted('internal_errors') == 0


def test_stale_input_is_dropped_at_opening(sink, host):
    waiting = open_port(str(sink.link), 115200, 1.0)  # someone held the port open, and read nothing
    sink.say(data(90), data(91)[:10])
    waiting.close()
    keep = os.open(sink.device, os.O_RDWR | os.O_NOCTTY)
    sink.say(data(92))
    up = host(timeout=dataclasses.replace(FAST, settle=0.2))
    up.wait_up()
    os.close(keep)
    sink.say(data(1))
    up.wait_seqs([1])


def test_port_that_is_open_elsewhere_is_refused_until_it_is_free(sink, host):
    other = open_port(str(sink.link), 115200, 1.0)
    with pytest.raises(TrackingError, match='in use by another program'):
        open_port(str(sink.link), 115200, 1.0)
    up = host()
    up.until(lambda: 'in use' in up.session.status.error)
    other.close()
    up.wait_up()


def test_port_that_does_not_exist_is_waited_for(link, host):
    up = host()
    up.until(lambda: 'no such port' in up.session.status.error)
    with contextlib.closing(FakeSink(link)):
        up.wait_up()
        up.session.close()


def test_reset_lines_of_a_port_that_has_none_are_an_error_that_says_so(sink, host):
    sink.mute = True
    up = host(toggle_dtr_rts=True)
    up.until(lambda: 'set toggle_dtr_rts to false' in up.session.status.error)


def test_session_can_be_closed_twice_and_gives_the_port_back(sink, host):
    up = host()
    up.wait_up()
    up.session.close()
    up.session.close()
    open_port(str(sink.link), 115200, 1.0).close()
    assert up.session.status.phase == 'closed'
