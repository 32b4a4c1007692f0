"""What a benchmark tells: rows of our figure, a peer's, their ratio and the goal; how contenders are timed."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

Contender = Callable[[], object]


class Sizes(NamedTuple):
    """How much work a benchmark takes on; the defaults are those of the figures that are told."""

    rounds: int = 5
    least: float = 0.1  # [s] CPU time that a contender is repeated for in one round
    batches: tuple[int, ...] = (3, 100, 1000)
    messages: int = 100_000  # of the bag that is read
    bag_s: float = 60.0  # recording at 10 Hz that is evaluated
    long_s: float = 3600.0  # recording at 1 Hz that is evaluated
    graph_s: float = 6.0  # for which the graph is fed
    walk_s: float = 20.0  # that a person walks live
    latencies: int = 500  # messages
    starts: int = 5  # of each node


class Goal(NamedTuple):
    """A bound on our figure, or on its ratio to the peer's."""

    limit: float
    at_least: bool
    of_ratio: bool

    def met(self, row: Row) -> bool | None:
        """Whether a row reaches it; None where that is not known."""
        value = row.ratio if self.of_ratio else row.ours
        if value is None:
            return None
        return value >= self.limit if self.at_least else value <= self.limit


class Row(NamedTuple):
    """One line of the table."""

    group: str
    work: str
    unit: str
    ours: float | None  # None: not measured, `note` says why
    peer: str = ''
    theirs: float | None = None
    goal: Goal | None = None
    faster_is_more: bool = True  # the ratio is theirs / ours; else ours / theirs
    note: str = ''

    @property
    def ratio(self) -> float | None:
        """How many times faster than the peer (or, of a start, how many times slower)."""
        if self.ours is None or self.theirs is None:
            return None
        return self.theirs / self.ours if self.faster_is_more else self.ours / self.theirs


def at_least(limit: float, *, ratio: bool = False) -> Goal:
    """Our figure (or the ratio) should be this or more."""
    return Goal(limit, at_least=True, of_ratio=ratio)


def at_most(limit: float, *, ratio: bool = False) -> Goal:
    """Our figure (or the ratio) should be this or less."""
    return Goal(limit, at_least=False, of_ratio=ratio)


def cpu_seconds(contenders: Mapping[str, Contender], sizes: Sizes) -> dict[str, float]:
    """Median CPU time of one call of each contender [s]; they take turns, so that what slows the machine slows all."""
    calls = {name: _calls(work, sizes.least) for name, work in contenders.items()}
    took: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(sizes.rounds):
        for name, work in contenders.items():
            took[name].append(_seconds(work, calls[name]) / calls[name])
    return {name: statistics.median(times) for name, times in took.items()}


def _calls(work: Contender, least: float) -> int:
    work()  # imports and caches
    calls = 1
    while (seconds := _seconds(work, calls)) < least / 4.0:
        calls *= 4
    return max(round(calls * least / seconds), 1) if seconds > 0.0 else calls


def _seconds(work: Contender, calls: int) -> float:
    began = time.process_time()
    for _ in range(calls):
        work()
    return time.process_time() - began
