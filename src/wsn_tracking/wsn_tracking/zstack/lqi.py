"""Link quality of the last hop into the sink, and the signal strength behind it (zstack.md, section 5).

A radio maps the signal strength, clipped to [low, high] dBm, onto 0..255 and rounds down. Every whole dB within has a
number of its own, so that the way back is exact; 0 and 255 stand for everything beyond the ends.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import NamedTuple

TOP = 255


class Scale(NamedTuple):
    """The range of signal strengths [dBm] that a firmware spreads over LQI 0..255."""

    low: int
    high: int


SCALES = {'cc2530': Scale(-87, 10), 'cc26x2': Scale(-90, -5)}


class Strength(NamedTuple):
    """Signal strength [dBm]; `censored` -1: that or weaker, +1: that or stronger, 0: exactly that."""

    rssi_dbm: int
    censored: int


class ScaleCheck(NamedTuple):
    """How many LQIs were looked at, and those that the scale cannot give."""

    seen: int
    unreachable: tuple[int, ...]


def lqi_of(rssi_dbm: int, scale: Scale) -> int:
    """What the radio reports for a signal strength."""
    clipped = min(max(rssi_dbm, scale.low), scale.high)
    return TOP * (clipped - scale.low) // (scale.high - scale.low)


def strength_of(lqi: int, scale: Scale) -> Strength:
    """The signal strength that a reported LQI stands for."""
    rssi = scale.low - (-lqi * (scale.high - scale.low) // TOP)  # -(-a // b) rounds up
    return Strength(rssi, -1 if lqi == 0 else 1 if lqi == TOP else 0)


def reachable(scale: Scale) -> frozenset[int]:
    """All LQIs that the scale can give."""
    return frozenset(lqi_of(rssi, scale) for rssi in range(scale.low, scale.high + 1))


def check_scale(lqis: Iterable[int], scale: Scale) -> ScaleCheck:
    """Whether a radio's LQIs can be of that scale: a single one that cannot says that another is configured."""
    seen = list(lqis)
    return ScaleCheck(len(seen), tuple(sorted(set(seen) - reachable(scale))))


def scale_words(lqis: Collection[int], name: str) -> str:
    """What the LQIs of messages say of the scale of that name, one of SCALES, and what to do."""
    if not lqis:
        return f'none seen: scale {name} not checked'
    checks = {each: check_scale(lqis, scale) for each, scale in SCALES.items()}
    fitting = [each for each, check in checks.items() if not check.unreachable]
    if name not in fitting:
        strange = checks[name].unreachable
        listed = ' '.join(map(str, strange[:8])) + ' ...' * (len(strange) > 8)
        advice = f'set lqi_scale to {fitting[0]}' if fitting else 'no known scale fits'
        return f'{len(lqis)} seen, scale {name} cannot give {listed}: {advice}'
    others = ', '.join(each for each in fitting if each != name)
    return f'{len(lqis)} seen, all fit scale {name}' + (f'; too few to rule out {others}' if others else '')
