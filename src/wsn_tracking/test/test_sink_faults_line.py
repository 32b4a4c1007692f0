"""Faults of the line: what damages no frame loses nothing, a damaged frame is lost alone."""

import itertools

import pytest
from fault_cases import ALL, WORLD, judged, ran, strikes, writes
from sink_cases import Host, epochs
from zstack_cases import is_subsequence

from wsn_tracking.zstack.faults.on_line import BOOT_TEXT

HARMLESS = ['garbage=0.5', 'boot_text=0.5', 'partial=0.5', 'byte_at_a_time', 'long_len=0.5', 'batch=5', 'stale']


@pytest.mark.parametrize('fault', HARMLESS)
@pytest.mark.parametrize('seed', [0, 1])
def test_nothing_is_lost_by_what_damages_no_frame(fault, seed):
    host = ran(fault, seed=seed)
    assert is_subsequence(ALL, host.heard())
    assert judged(host)[1] == ALL
    assert strikes(host) > 0


@pytest.mark.parametrize('fault', ['bad_fcs=0.1', 'corrupted_len=0.1', 'cut=0.1'])
@pytest.mark.parametrize('seed', [0, 1])
def test_damaged_frames_are_lost_and_no_others(fault, seed):
    host = ran(fault, seed=seed)
    struck = strikes(host)
    assert struck > 5
    counters, heard = judged(host)
    assert len(ALL) - struck <= len(heard) < len(ALL)
    assert is_subsequence(heard, ALL)
    assert set(counters) <= {'lost_messages'}


def test_bytes_come_one_at_a_time():
    assert {len(write) for write in writes(ran('byte_at_a_time'))} == {1}


def test_frames_come_several_at_a_time():
    host = ran('batch=4', world=epochs(30, nodes=8))
    frames = [write.count(b'\xfe\x2a\x44\x81') for write in writes(host)]
    assert max(frames) >= 3
    assert host.simulator.faults[0].strikes > 30


def test_pieces_of_a_frame_are_apart_but_less_than_a_gap():
    host = ran('partial=1')
    times = [t for t, action in host.actions if isinstance(action, bytes)]
    pauses = [b - a for a, b in itertools.pairwise(times) if b > a]
    assert min(pauses) < 0.05
    assert host.protocol.counters['gaps'] == 0


def test_broken_off_frame_is_followed_by_a_pause():
    host = ran('cut=0.2')
    assert host.protocol.counters['gaps'] > 5


def test_boot_text_and_stale_input_are_there_at_the_plug():
    host = Host(WORLD, faults=('boot_text=0', 'stale'))
    host.until(host.now)
    (said,) = writes(host)
    assert BOOT_TEXT in said
    assert len(host.reports) == 3  # old ones; the host drops what comes before it asks


def test_line_of_text_with_a_wrong_check_is_rejected():
    host = ran('bad_fcs=0.3', sink_protocol='ascii')
    assert set(host.bad()) == {'line_checksum'}
    assert len(host.reports) + len(host.bad()) == len(ALL)
