import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from zstack_cases import properties

from wsn_tracking.zstack.beacons import KEPT, Robot, pair

MS = 1_000_000


class Host:
    def __init__(self):
        self.robot = Robot()

    def pair(self, beacon, time_ms):
        self.robot, seq, first = pair(self.robot, beacon, int(time_ms * MS))
        return seq, first


@settings(properties, max_examples=30)
@given(st.integers(0, 255), st.integers(0, 10**6), st.floats(0.0, 0.9), st.integers(60, 1000))
def test_reports_of_one_request_meet_over_wraps_loss_and_disorder(start, seed, loss, period):
    draw, host, reports = random.Random(seed), Host(), []
    for k in range(400):
        for _ in range(3):
            if not 0 < k < 399 or draw.random() >= loss:
                measured = period * k + draw.uniform(0, 20)
                reports.append((period * k + draw.uniform(0, 3 * period), k, measured))
    found, outage = {}, 0
    for _, k, measured in sorted(reports):
        outage = max(outage, k - max(found, default=k))
        seq, first = host.pair((start + k) % 256, measured)
        assert first == (k not in found)
        assert found.setdefault(k, seq) == seq
    if outage < 100:  # 256 requests that nobody heard cannot be counted
        offsets = {seq - k for k, seq in found.items() if k >= 5}
        assert len(offsets) == 1


def test_number_that_comes_back_is_another_request():
    host = Host()
    assert host.pair(7, 0) == (7, True)
    assert host.pair(7, 400) == (7, False)
    assert host.pair(7, 25_600) == (7 + 256, True)


def test_request_that_nobody_else_heard_finds_its_place():
    host = Host()
    host.pair(10, 1000)
    host.pair(12, 1200)
    assert host.pair(11, 1100) == (11, True)
    assert host.pair(12, 1205) == (12, False)
    assert host.pair(13, 1300) == (13, True)


@pytest.mark.parametrize('period', [50, 100, 1000])
@pytest.mark.parametrize('held_up', [600, 1600, 2900])
def test_report_that_was_held_up_belongs_to_its_request_and_moves_no_other(period, held_up):
    host = Host()
    behind = held_up // period
    for k in range(250):
        if k != 150:
            assert host.pair(k, period * k) == (k, True)
        if k == 120 + behind:
            assert host.pair(120, period * 120 + held_up) == (120, False)
        if k == 150 + behind:  # of which nobody else had told
            assert host.pair(150, period * 150 + held_up) == (150, True)
            times = [time for _, time in host.robot.requests]
            assert times == sorted(times)


def test_report_that_was_held_up_after_a_pause_moves_no_other():
    """The robot pauses for 2 s, the link for 4: counted back from the last request before, it would be too old."""
    host = Host()
    for k in range(40):
        host.pair(k, 250 * k)
    after = [(k, 250 * k + 2000) for k in range(40, 60)]
    assert host.pair(*after[8]) == (48, True)
    assert host.pair(41, after[8][1] + 10) == (41, True)
    assert [host.pair(*word) for word in after[9:]] == [(k, True) for k in range(49, 60)]


def test_robot_that_restarts_goes_on_upwards():
    host = Host()
    for k in range(200):
        host.pair(k, 100 * k)
    seqs = [host.pair(k, 30_000 + 100 * k)[0] for k in range(10)]
    assert seqs == list(range(256, 266))


def test_reports_without_a_number_are_paired_by_time():
    host = Host()
    seqs = [host.pair(None, t)[0] for t in (0, 30, 100, 120, 90, 200)]
    assert seqs == [0, 0, 1, 1, 1, 2]


@pytest.mark.parametrize('beacon', [None, 3])
def test_memory_is_bounded(beacon):
    host = Host()
    for k in range(1000):
        host.pair(None if beacon is None else (beacon + k) % 256, 1000 * k)
    assert len(host.robot.requests) == KEPT
