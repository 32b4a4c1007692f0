"""The sink's clock on the host's (zstack.md, section 5).

The sink stamps each message when its radio receives it, in ticks that wrap. The host sees it some milliseconds later,
after the serial line and its own delays, which are never negative: the smallest difference (arrival - sink time) is the
offset of the clocks, up to the shortest delay. Crystals drift, so an old minimum may rise by `drift_ppm`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from wsn_tracking.parameters import param

SECOND_NS = 1_000_000_000


@dataclass(frozen=True)
class ClockConfig:
    """How the sink counts time."""

    sink_tick_us: int = param(320, 'length of a tick of the sink clock; CC26x2: 16', 'us', low=1, high=100_000)
    sink_tick_modulus: int = param(0xFF0000, 'ticks after which the sink clock starts again', '', low=256, high=2**32)
    silence_s: float = param(2640.0, 'silence after which the wraps can no longer be counted', 's', low=1.0, high=1e6)
    drift_ppm: float = param(50.0, 'how fast the two crystals may drift apart', 'ppm', low=0.0, high=1000.0)
    strange_s: float = param(10.0, 'a message this much later or earlier than all before is not believed', 's', low=0.1)
    strange_count: int = param(3, 'so many strange messages in a row start the clock anew', '', low=1, high=1000)


class SinkClock(NamedTuple):
    """What is known of the sink's clock; start from `SinkClock()`, and again after every reset of the sink."""

    ticks: int | None = None  # of the newest message, unwrapped
    arrival_ns: int = 0  # of the last message, host clock
    offset_ns: int = 0  # host - sink
    strange: int = 0  # strange messages in a row
    restarts: int = 0  # silences and jumps so far


class Stamped(NamedTuple):
    """When the sink's radio received the message, on the host's steady clock [ns]; `strange`: it is the arrival."""

    clock: SinkClock
    time_ns: int
    strange: bool = False


def stamp(clock: SinkClock, ticks: int, arrival_ns: int, config: ClockConfig) -> Stamped:
    """Reception time of the message that bears `ticks` and was read from the line at `arrival_ns`."""
    ticks %= config.sink_tick_modulus
    silence = arrival_ns - clock.arrival_ns
    if clock.ticks is None:
        return _start(clock, ticks, arrival_ns, config, clock.restarts)
    if silence > config.silence_s * SECOND_NS:
        return _start(clock, ticks, arrival_ns, config, clock.restarts + 1)
    # Messages may overtake each other: of the two ways round, the shorter one.
    half = config.sink_tick_modulus // 2
    unwrapped = clock.ticks + (ticks - clock.ticks + half) % config.sink_tick_modulus - half
    difference = arrival_ns - unwrapped * config.sink_tick_us * 1000
    offset = clock.offset_ns + int(silence * config.drift_ppm * 1e-6)
    if abs(difference - offset) > config.strange_s * SECOND_NS:
        if clock.strange + 1 >= config.strange_count:
            return _start(clock, ticks, arrival_ns, config, clock.restarts + 1)
        return Stamped(clock._replace(strange=clock.strange + 1), arrival_ns, strange=True)
    offset = min(offset, difference)
    clock = SinkClock(max(clock.ticks, unwrapped), arrival_ns, offset, 0, clock.restarts)
    return Stamped(clock, unwrapped * config.sink_tick_us * 1000 + offset)


def _start(clock: SinkClock, ticks: int, arrival_ns: int, config: ClockConfig, restarts: int) -> Stamped:
    offset = arrival_ns - ticks * config.sink_tick_us * 1000
    return Stamped(SinkClock(ticks, arrival_ns, offset, 0, restarts), arrival_ns)
