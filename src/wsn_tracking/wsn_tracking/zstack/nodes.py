"""The nodes that are heard: one window of duplicates for each address under which a node speaks.

A node that rejoins gets another network address and goes on (or begins anew): accepted, and its window moves with it.
Two radios with the same id take turns: both are accepted, each with its own window, and it is said.
"""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.duplicates import WIDTH, Seen, Verdict, Window, begin, see
from wsn_tracking.zstack.payload import Flag
from wsn_tracking.zstack.reports import Report

ADDRESSES = 4  # remembered of each node
STREAMS = 4096  # remembered altogether
CONFLICT_NS = 60_000_000_000  # a node does not go back to an address that soon
MS_NS = 1_000_000

Stream = tuple[int, int]  # as Report.stream


class Station(NamedTuple):
    """What is remembered of a node at one address."""

    src: int | None
    heard_ns: int
    window: Window


class Judged(NamedTuple):
    """What a report is, and by how much the number of lost messages has changed."""

    verdict: Verdict
    lost: int = 0
    moved: bool = False  # another address than before
    conflict: bool = False  # two radios have the same id


class Nodes:
    """Windows of all nodes, in bounded memory."""

    def __init__(self) -> None:
        self._stations: dict[Stream, tuple[Station, ...]] = {}  # of each node newest first

    def judge(self, report: Report, now_ns: int) -> Judged:
        """Judge a report that came at `now_ns`; of one without a number nothing can be told."""
        if report.payload.seq is None:
            return Judged(Verdict.NEW)
        known = self._stations.pop(report.stream, ())
        mine = next((station for station in known if station.src == report.src), None)
        seen = _see(report, mine, known, now_ns // MS_NS)
        others = tuple(station for station in known if station.src != report.src)
        self._stations[report.stream] = (Station(report.src, now_ns, seen.window), *others)[:ADDRESSES]
        if len(self._stations) > STREAMS:
            del self._stations[next(iter(self._stations))]  # the one that was silent for longest
        moved = bool(known) and known[0].src != report.src
        conflict = moved and mine is not None and now_ns - mine.heard_ns < CONFLICT_NS
        return Judged(seen.verdict, seen.lost, moved, conflict)


def _see(report: Report, mine: Station | None, known: tuple[Station, ...], now_ms: int) -> Seen:
    payload = report.payload
    assert payload.seq is not None
    t_ms = payload.t_ms or 0
    if not known:
        return begin(payload.seq, t_ms, now_ms)
    window = mine.window if mine else known[0].window
    seen = see(window, payload.seq, t_ms, now_ms, retry=bool(payload.flags & Flag.RETRY))
    if mine is None and (seen.verdict is Verdict.LATE or seen.lost > WIDTH):  # nothing that goes on: another radio
        return begin(payload.seq, t_ms, now_ms, Verdict.RESTARTED)
    return seen
