"""From what the link delivers to what was measured and when: the sink's clock, duplicates, the scale of LQI."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.clock import ClockConfig, SinkClock, stamp
from wsn_tracking.zstack.commands import SysResetInd
from wsn_tracking.zstack.duplicates import TIME_MODULUS, Verdict
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.lqi import Scale, reachable
from wsn_tracking.zstack.nodes import Judged, Nodes
from wsn_tracking.zstack.payload import Flag
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.reports import Report

MS_NS = 1_000_000
# Nodes whose clocks are synchronised count milliseconds together.
NETWORK_CLOCK = ClockConfig(sink_tick_us=1000, sink_tick_modulus=TIME_MODULUS, silence_s=1e6)

COUNTERS = (
    'duplicates',
    'reordered',
    'lost_messages',
    'late_messages',
    'node_restarts',
    'address_changes',
    'address_conflicts',
    'clock_restarts',
    'clock_strange',
    'lqi_unreachable',
)
BY_VERDICT = {
    Verdict.DUPLICATE: 'duplicates',
    Verdict.REORDERED: 'reordered',
    Verdict.LATE: 'late_messages',
    Verdict.RESTARTED: 'node_restarts',
}


class Taken(NamedTuple):
    """A report, when it left its node (host clock, monotonic) [ns], and what it is; duplicates are not to be used."""

    report: Report
    time_ns: int
    judged: Judged

    @property
    def is_new(self) -> bool:
        """Whether it has not come before."""
        return self.judged.verdict is not Verdict.DUPLICATE

    def measured_ns(self, age_ms: int | None) -> int | None:
        """When a record of that age was measured; None where it is too old to tell."""
        return None if age_ms is None else self.time_ns - age_ms * MS_NS


class Intake:
    """Feed it everything that comes out of the inbox, in order."""

    def __init__(self, clock: ClockConfig, scale: Scale) -> None:
        self.counters = dict.fromkeys(COUNTERS, 0)
        self.lqis: set[int] = set()  # all that have come
        self._config = clock
        self._reachable = reachable(scale)
        self._nodes = Nodes()
        self._sink = SinkClock()
        self._network = SinkClock()

    def take(self, received: Received) -> Taken | None:
        """What a report means; None for everything else."""
        item, arrival_ns = received
        if isinstance(item, SysResetInd) or (isinstance(item, LinkEvent) and item.kind in {'opened', 'restarted'}):
            self._sink = SinkClock()
        if not isinstance(item, Report):
            return None
        time_ns = self._time(item, arrival_ns)
        judged = self._nodes.judge(item, arrival_ns)
        counters = self.counters
        if judged.verdict in BY_VERDICT:
            counters[BY_VERDICT[judged.verdict]] += 1
        counters['lost_messages'] += judged.lost
        counters['address_changes'] += judged.moved
        counters['address_conflicts'] += judged.conflict
        if item.lqi is not None:
            self.lqis.add(item.lqi)
            counters['lqi_unreachable'] += item.lqi not in self._reachable
        return Taken(item, time_ns, judged)

    def _time(self, report: Report, arrival_ns: int) -> int:
        time_ns = arrival_ns
        if report.ticks is not None:
            before = self._sink.restarts
            self._sink, time_ns, strange = stamp(self._sink, report.ticks, arrival_ns, self._config)
            self.counters['clock_restarts'] += self._sink.restarts - before
            self.counters['clock_strange'] += strange
        payload = report.payload
        if payload.flags & Flag.CLOCK_SYNCHRONISED and payload.t_ms is not None:
            self._network, time_ns, _ = stamp(self._network, payload.t_ms, time_ns, NETWORK_CLOCK)
        return time_ns
