import random
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from zstack_cases import properties

from wsn_tracking.zstack.clock import ClockConfig, SinkClock, stamp

S = 1_000_000_000
CONFIG = ClockConfig()
TICK_NS = 320_000
WRAP_S = 0xFF0000 * 320e-6


class Radio:
    """The sink's clock, `ppm` too fast, and a line whose delays are never below 2 ms."""

    def __init__(self, seed=0, ppm=0.0, start_ticks=0.0):
        self.draw = random.Random(seed)
        self.rate = 1 + ppm * 1e-6
        self.start = start_ticks

    def ticks(self, t):
        return int(self.start + t * self.rate / 320e-6) % 0xFF0000

    def hear(self, clock, t, delay=None):
        delay = 0.002 + self.draw.expovariate(1 / 0.003) if delay is None else delay
        return stamp(clock, self.ticks(t), int((1000 + t + delay) * S), CONFIG)


@pytest.mark.parametrize('ppm', [-40, 0, 40])
def test_stamps_are_free_of_the_lines_jitter_over_wraps_and_drift(ppm):
    radio, clock = Radio(1, ppm, start_ticks=0xFF0000 - 1000), SinkClock()
    errors = []
    for k in range(40_000):  # 4 wraps
        t = 0.55 * k
        clock, time_ns, strange = radio.hear(clock, t)
        assert not strange
        errors.append(time_ns / S - 1000 - t)
    settled = errors[200:]
    assert max(settled) - min(settled) < 0.004
    assert 0.0 < sum(settled) / len(settled) < 0.005
    assert clock.restarts == 0
    assert clock.ticks * 320e-6 > 4 * WRAP_S


@properties
@given(st.lists(st.tuples(st.floats(0.0, 5.0), st.floats(0.0, 1.0)), min_size=1, max_size=50), st.integers(0, 0xFEFFFF))
def test_reception_is_never_after_arrival(steps, start):
    radio, clock, t, arrived = Radio(0, 0, start), SinkClock(), 0.0, 0.0
    for step, delay in steps:
        t += step
        arrived = max(arrived, t + delay)  # the line keeps the order
        clock, time_ns, _ = stamp(clock, radio.ticks(t), int(arrived * S), CONFIG)
        assert time_ns <= int(arrived * S)


def test_differences_of_stamps_are_those_of_the_sink_where_the_line_is_held_up():
    radio, clock = Radio(), SinkClock()
    clock = radio.hear(clock, 0.0, 0.002).clock
    times = []
    for k in range(1, 60):
        clock, time_ns, _ = radio.hear(clock, 0.1 * k, 6.0 - 0.1 * k)  # all come at once, at 6 s
        times.append(time_ns)
    assert all(abs(b - a - 0.1 * S) <= 2 * TICK_NS for a, b in pairwise(times))


def test_overtaking_message_is_stamped_before_the_one_it_overtook():
    radio, clock = Radio(start_ticks=0xFF0000 - 10), SinkClock()
    clock, first, _ = radio.hear(clock, 0.05, 0.002)  # after the wrap
    clock, second, strange = radio.hear(clock, 0.0, 0.053)  # before it
    assert not strange
    assert abs(first - second - 0.05 * S) <= 2 * TICK_NS


def test_silence_of_44_minutes_starts_anew_and_a_shorter_one_does_not():
    radio = Radio()
    clock = radio.hear(SinkClock(), 0.0, 0.002).clock
    kept = radio.hear(clock, 2639.0, 0.5)
    assert kept.clock.restarts == 0
    assert abs(kept.time_ns - 3639 * S) < 0.2 * S  # the late arrival does not count, up to the drift allowed for
    anew = radio.hear(clock, 2641.0, 0.5)
    assert anew.clock.restarts == 1
    assert anew.time_ns == int(3641.5 * S)


def test_one_corrupt_tick_changes_nothing_afterwards():
    radio = Radio()
    clock = radio.hear(SinkClock(), 0.0, 0.002).clock
    odd = stamp(clock, 0x800000, 1001 * S, CONFIG)
    assert odd.strange
    assert odd.time_ns == 1001 * S
    after = radio.hear(odd.clock, 2.0, 0.002)
    assert (after.strange, after.clock.strange, after.clock.restarts) == (False, 0, 0)
    assert abs(after.time_ns - int(1002.002 * S)) < S // 1000


def test_reset_that_was_not_announced_is_found_after_three_messages():
    clock = Radio(start_ticks=5_000_000).hear(SinkClock(), 0.0, 0.002).clock
    radio = Radio()  # counts from zero again
    for k in range(1, 4):
        clock, time_ns, strange = radio.hear(clock, float(k), 0.002)
        assert time_ns == int((1000 + k + 0.002) * S)
        assert strange == (k < 3)
    assert clock.restarts == 1
    assert not radio.hear(clock, 4.0, 0.002).strange


def test_tick_and_modulus_are_parameters():
    config = ClockConfig(sink_tick_us=16, sink_tick_modulus=1 << 24)
    clock = stamp(SinkClock(), (1 << 24) - 1, 0, config).clock
    assert stamp(clock, 62499, S, config).time_ns == S  # one second of 16 us ticks, over the wrap
