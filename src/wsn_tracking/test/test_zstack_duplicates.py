import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties

from wsn_tracking.zstack.duplicates import WIDTH, Verdict, begin, see

NEW, DUPLICATE, REORDERED = Verdict.NEW, Verdict.DUPLICATE, Verdict.REORDERED


class Host:
    """Judges messages in order; sums up what was lost."""

    def __init__(self):
        self.window = None
        self.lost = 0

    def hear(self, seq, t_ms, now_ms=None, *, retry=False):
        now_ms = t_ms if now_ms is None else now_ms
        seq, t_ms = seq % 65536, t_ms % 2**32
        seen = begin(seq, t_ms, now_ms) if self.window is None else see(self.window, seq, t_ms, now_ms, retry=retry)
        self.window, self.lost = seen.window, self.lost + seen.lost
        return seen.verdict


@properties
@given(
    st.integers(0, 65535),
    st.integers(0, 2**32 - 1),
    st.integers(0, 10**6),
    st.floats(0.0, 0.5),
    st.floats(0.0, 0.5),
    st.floats(0.0, 0.5),
)
def test_verdicts_equal_those_of_unlimited_memory(first, start_ms, seed, loss, repeat, delay):
    """Any lost, repeated up to 60 messages later, delayed up to 20 messages; numbers and times wrap."""
    draw, arrivals = random.Random(seed), []
    for k in range(300):
        if draw.random() < loss and k:
            continue
        place = k + (draw.randrange(1, 20) if k and draw.random() < delay else 0)
        arrivals.append((place, k))
        if draw.random() < repeat:
            arrivals.append((place + draw.randrange(40), k))
    arrivals.sort(key=lambda arrival: arrival[0])
    host, seen, newest = Host(), set(), -1
    for place, k in arrivals:
        verdict = host.hear(first + k, start_ms + 100 * k, 10**9 + 100 * place)
        assert verdict == (DUPLICATE if k in seen else NEW if k > newest else REORDERED)
        seen.add(k)
        newest = max(newest, k)
    assert host.lost == newest + 1 - len(seen)


@pytest.mark.parametrize('seq', [0, 1, 63, 64, 100, 65535])
def test_numbers_wrap(seq):
    host = Host()
    assert [host.hear(seq + k, 1000 + k) for k in (-2, -1, 0, 1, 0, -2, 2)] == [NEW] * 4 + [DUPLICATE] * 2 + [NEW]
    assert host.lost == 0


def test_window_holds_64_numbers():
    host = Host()
    for k in range(100):
        host.hear(k, 10**7 + 100 * k)
    assert host.hear(100 - WIDTH, 10**7 + 100 * (100 - WIDTH)) is DUPLICATE
    assert host.hear(99 - WIDTH, 10**7 + 100 * (99 - WIDTH)) is Verdict.LATE
    assert host.hear(100, 10**7 + 10_000) is NEW


@pytest.mark.parametrize('up', [1, 5, 40, 70, 5000, 65000, 70000])
@pytest.mark.parametrize('missed', [0, 1, 3])
def test_node_that_restarts_loses_nothing(up, missed):
    """It ran for `up` messages; of those after the restart the first `missed` do not come."""
    host, period = Host(), 1000
    for k in range(up):
        host.hear(k, 200 + period * k)
    down = 200 + period * up + 5000
    verdicts = [host.hear(k, 200 + period * k, down + period * k) for k in range(missed, missed + 100)]
    assert DUPLICATE not in verdicts
    assert verdicts.count(Verdict.RESTARTED) <= 1
    assert verdicts[-1] is NEW


def test_restart_is_seen_with_a_clock_that_goes_on():
    """The network gives the time (flag 1), only the numbers begin anew."""
    host = Host()
    for k in range(30):
        host.hear(k, 10**8 + 100 * k)
    verdicts = [host.hear(k, 10**8 + 5000 + 100 * k) for k in range(30)]
    assert verdicts == [Verdict.RESTARTED] + [NEW] * 29


def test_time_wraps_after_49_days():
    host = Host()
    verdicts = [host.hear(k, 2**32 - 1000 + 100 * k, 10**9 + 100 * k) for k in range(20)]
    assert verdicts == [NEW] * 20


def test_retry_with_a_new_time_is_a_duplicate_where_it_says_so():
    host = Host()
    host.hear(1, 1000)
    host.hear(2, 1100)
    assert host.hear(1, 1150, retry=True) is DUPLICATE
    assert host.hear(2, 1200, retry=True) is DUPLICATE
    assert host.hear(3, 1300, retry=True) is NEW  # the first attempt did not come


def test_long_outage_is_loss_and_no_restart():
    host = Host()
    host.hear(10, 10**6)
    assert host.hear(10 + 3000, 10**6 + 300_000) is NEW
    assert host.lost == 2999


def test_messages_held_up_in_the_host_are_no_restart():
    host = Host()
    host.hear(0, 10**6, 5_000)
    assert [host.hear(k, 10**6 + 100 * k, 65_000) for k in range(1, 100)] == [NEW] * 99


def test_messages_from_before_the_first_one_are_new():
    host = Host()
    verdicts = [host.hear(seq, 10**6 + 100 * seq) for seq in (10, 7, 8, 9, 7, 11)]
    assert verdicts == [NEW, REORDERED, REORDERED, REORDERED, DUPLICATE, NEW]
    assert host.lost == 0


def test_restart_among_numbers_that_were_lost_is_seen_by_the_time():
    """Numbers 1 to 4 of the first run never came; after the restart they do, with times that do not fit between."""
    host = Host()
    for seq in (0, 5, 6, 7):
        host.hear(seq, 50_000 + 1000 * seq)
    verdicts = [host.hear(seq, 100 * seq, 60_000 + 100 * seq) for seq in range(2, 10)]
    assert verdicts == [Verdict.RESTARTED] + [NEW] * 7


def test_restart_with_higher_numbers_is_seen_by_the_time():
    host = Host()
    host.hear(65_000, 10**7)
    assert host.hear(3, 300, 10**7 + 4000) is Verdict.RESTARTED
    assert host.lost == 0
