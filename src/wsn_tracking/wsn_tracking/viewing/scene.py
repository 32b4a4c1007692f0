"""What a running graph shows: the latest epochs of its outputs, its targets and its nodes, and no more than that."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.values import TriggerReport
from wsn_tracking.trackers.consensus_report import ConsensusReport
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.viewing.node_states import ARRIVED, LOST, SENT

TRUTHS_PER_EPOCH = 4  # a truth of 100 Hz is not drawn sample by sample
LIKELY = 0.5  # probability from which on an observation is taken to have arrived
NEW_RUN_NS = 1_000_000_000  # stamps that fall back by more begin a new run, as everywhere


class Track(NamedTuple):
    """The latest epochs of one output for one target, ascending in time."""

    name: str  # of the output, e.g. fused_1
    target_id: int
    estimates: tuple[Estimate, ...]


class Trail(NamedTuple):
    """Where one target really was, ascending in time; stamps (K,) [ns], positions (K, 2) [m]."""

    target_id: int
    stamps_ns: NDArray[np.int64]
    positions: Floats


class Links(NamedTuple):
    """The network of a target's latest epoch: whose shares were used by whom, and who can reach each other."""

    target_id: int
    pairs: tuple[tuple[int, int], ...]  # of ids, the lower first, ascending
    components: tuple[tuple[int, ...], ...]  # ids, the largest component first


class Scene:
    """Holds at most `length` epochs; `version` counts what came, so that nothing is drawn twice."""

    def __init__(self, length: int) -> None:
        self.length = length
        self.version = 0
        self.anchors: Anchors | None = None
        self._estimates: dict[tuple[str, int], deque[Estimate]] = {}
        self._truths: dict[int, deque[tuple[int, Floats]]] = {}
        self._nodes: dict[int, dict[int, tuple[int, int]]] = {}  # target -> node -> request_seq, state
        self._reported: dict[int, TriggerReport | ConsensusReport] = {}  # latest of each target
        self._networks: dict[int, dict[int, tuple[int, int, tuple[int, ...]]]] = {}  # node -> seq, component, heard

    def add_anchors(self, anchors: Anchors) -> None:
        """A (new) table."""
        self.anchors = anchors
        self.version += 1

    def add_estimate(self, name: str, estimate: Estimate) -> None:
        """An output's next estimate; one without a position in the plane is nothing that can be drawn."""
        if estimate.mean.size < 2 or not np.all(np.isfinite(estimate.mean[:2])):
            return
        held = self._estimates.setdefault((name, estimate.target_id), deque(maxlen=self.length))
        if held and estimate.stamp_ns < held[-1].stamp_ns - NEW_RUN_NS:
            held.clear()
        held.append(estimate)
        self.version += 1

    def add_truth(self, target_id: int, stamp_ns: int, position: Floats) -> None:
        """A target's next true position, (2 or 3,) [m]; the newest is always held, older ones thinned to what shows."""
        if not np.all(np.isfinite(position[:2])):
            return
        held = self._truths.setdefault(target_id, deque(maxlen=TRUTHS_PER_EPOCH * self.length))
        if held and stamp_ns < held[-1][0] - NEW_RUN_NS:
            held.clear()
        if len(held) > 1 and held[-1][0] - held[-2][0] < self.window_ns / (TRUTHS_PER_EPOCH * self.length):
            held.pop()  # it was the newest, and is too close to the one before to stay
        held.append((stamp_ns, np.asarray(position[:2], dtype=np.float64)))
        self.version += 1

    def add_report(self, report: TriggerReport) -> None:
        """What sensing nodes did in an epoch; several reports may tell of one epoch."""
        nodes = self._reported_by(report)
        nodes.update(dict.fromkeys(report.sent_ids, (report.request_seq, SENT)))
        for node, reason in zip(report.silent_ids, report.reasons, strict=True):
            nodes[node] = (report.request_seq, reason)
        self.version += 1

    def add_consensus(self, report: ConsensusReport) -> None:
        """How nodes of system B came out of an epoch; several reports may tell of one epoch."""
        nodes, seq = self._reported_by(report), report.request_seq
        network = self._networks.setdefault(report.target_id, {})
        heard: dict[int, list[int]] = {node: [] for node in report.node_ids}
        for sender, receiver in zip(report.link_senders, report.link_receivers, strict=True):
            heard.setdefault(receiver, []).append(sender)
        told = zip(report.node_ids, report.arrival_probabilities, report.components, strict=True)
        for node, probability, component in told:
            nodes[node] = (seq, ARRIVED if probability >= LIKELY else LOST)
            network[node] = (seq, component, tuple(heard[node]))
        self.version += 1

    def _reported_by(self, report: TriggerReport | ConsensusReport) -> dict[int, tuple[int, int]]:
        """The states of a report's target; those of an earlier run are forgotten."""
        before = self._reported.get(report.target_id)
        if before is not None and report.stamp_ns < before.stamp_ns - NEW_RUN_NS:
            self._nodes.pop(report.target_id)
            self._networks.pop(report.target_id, None)
        self._reported[report.target_id] = report
        return self._nodes.setdefault(report.target_id, {})

    def forget(self, name: str) -> None:
        """An output is not shown any more."""
        for key in [key for key in self._estimates if key[0] == name]:
            del self._estimates[key]
        self.version += 1

    @property
    def tracks(self) -> tuple[Track, ...]:
        """Every output's track, by name and target."""
        return tuple(Track(name, target, tuple(held)) for (name, target), held in sorted(self._estimates.items()))

    @property
    def trails(self) -> tuple[Trail, ...]:
        """Every target's truth, by target."""
        return tuple(
            Trail(target, np.array([stamp for stamp, _ in held]), np.array([place for _, place in held]))
            for target, held in sorted(self._truths.items())
        )

    @property
    def node_states(self) -> dict[int, int]:
        """SENT or the Reason of every node that told of this epoch or the one before; sent to any target is sent."""
        states: dict[int, int] = {}
        for target, nodes in self._nodes.items():
            newest = self._reported[target].request_seq
            for node, (seq, state) in nodes.items():
                if newest - seq <= 1 and states.get(node) != SENT:
                    states[node] = state
        return states

    @property
    def links(self) -> tuple[Links, ...]:
        """The network of every target, by target, of the nodes that told of this epoch or the one before."""
        every = []
        for target, network in sorted(self._networks.items()):
            newest = self._reported[target].request_seq
            fresh = {node: row for node, row in network.items() if newest - row[0] <= 1}
            pairs = {(min(i, j), max(i, j)) for j, (_, _, heard) in fresh.items() for i in heard}
            groups: dict[int, list[int]] = {}
            for node, (_, component, _) in sorted(fresh.items()):
                groups.setdefault(component, []).append(node)
            components = sorted(map(tuple, groups.values()), key=lambda group: (-len(group), group))
            every.append(Links(target, tuple(sorted(pairs)), tuple(components)))
        return tuple(every)

    @property
    def reported_ns(self) -> int:
        """Stamp of the latest report [ns]; 0 before the first."""
        return max((report.stamp_ns for report in self._reported.values()), default=0)

    @property
    def newest(self) -> Estimate | None:
        """The latest estimate of all."""
        return max((held[-1] for held in self._estimates.values() if held), key=lambda e: e.stamp_ns, default=None)

    @property
    def window_ns(self) -> float:
        """How long the `length` epochs of a full track last, extrapolated from the longest there is."""
        held: deque[Estimate] = max(self._estimates.values(), key=len, default=deque())
        if len(held) < 2:
            return 0.0
        return max(held[-1].stamp_ns - held[0].stamp_ns, 0) * self.length / (len(held) - 1)


def pick(names: Iterable[str]) -> tuple[str, ...]:
    """One output of each kind and target, the first by number: three estimators that agree would hide each other.

    Local estimates are left out where fused ones are there.
    """
    first: dict[tuple[str, str], tuple[int, str]] = {}
    for name in names:
        kind, number, target = _parts(name)
        first[kind, target] = min(first.get((kind, target), (number, name)), (number, name))
    shown = [name for (kind, _), (_, name) in first.items() if kind != 'local' or ('fused', '') not in first]
    return tuple(sorted(shown))


def _parts(name: str) -> tuple[str, int, str]:
    """Kind, number (-1: none) and target of an output: consensus_3_target_2 -> consensus, 3, _target_2."""
    match = re.fullmatch(r'(.+?)(?:_(\d+))?(_target_\d+)?', name)
    assert match is not None  # the first group takes any name
    kind, number, target = match.groups()
    return kind, -1 if number is None else int(number), target or ''
