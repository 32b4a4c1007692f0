"""consensus_node: nodes of system B, one or many in a process; they agree with their neighbours within every epoch."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from typing import Any

from nav_msgs.msg import Odometry
from wsn_tracking_msgs import msg

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.nodes import convert, convert_consensus, qos
from wsn_tracking.nodes.assembly import Assembly
from wsn_tracking.nodes.base import TrackingNode, run
from wsn_tracking.nodes.health import Health, neighbours, worst
from wsn_tracking.nodes.inputs import take_measurements
from wsn_tracking.sensing.values import Epoch, EpochEnd
from wsn_tracking.trackers.consensus_door import Door
from wsn_tracking.trackers.consensus_group import ConsensusGroup
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_report import Outcome, report_of
from wsn_tracking.trackers.consensus_share import Share
from wsn_tracking.trackers.estimate import Estimate

TICKS = (0.002, 0.1)  # [s] least and most time between two looks at round timeouts; a third of one where possible


class ConsensusProcess(TrackingNode[ConsensusNodeConfig]):
    """Feeds a ConsensusGroup with epochs and foreign shares, and publishes what its nodes say.

    Every foreign topic is subscribed once, however many nodes here are its neighbours.
    """

    def __init__(self) -> None:
        super().__init__('consensus_node', ConsensusNodeConfig)
        self.config.checked()
        self._group: ConsensusGroup | None = None
        self._epoch = -1
        self._outcomes: dict[int, dict[int, Outcome]] = {}  # of the nodes that have finished an epoch, by its number
        self._begun: dict[int, float] = {}  # steady time at which an epoch's input was complete
        self._took = self._longest = 0.0
        self._shares: dict[int, Any] = {}
        self._estimates: dict[int, tuple[Any, Any]] = {}
        self._reports = self.create_publisher(msg.ConsensusReport, 'consensus_report', qos.MEASUREMENTS)
        self._assembly = Assembly(self, self.config, self._begin, self._anew)
        self._inputs = ('observation', 'range') if self.config.input == 'auto' else (self.config.input,)
        for topic in self._inputs:
            take_measurements(self, topic, self._assembly)
        self.take(msg.LocationRequest, 'request', convert.request_value, self._assembly.request, qos.MEASUREMENTS)
        self.take(msg.EpochEnd, 'epoch_end', convert.epoch_end_value, self._end, qos.MEASUREMENTS)
        self.take_anchors()
        self.create_timer(min(max(self.config.longest_round / 3.0, TICKS[0]), TICKS[1]), self._look_at_time)

    def on_anchors(self, anchors: Anchors) -> None:
        """Make the nodes, and subscribe their neighbours elsewhere."""
        config = self.config
        ids = anchors.select(config.ids).ids.tolist() if config.ids else anchors.ids.tolist()
        nodes = {i: ConsensusNode(config, anchors, i, config.neighbours) for i in ids}
        group = ConsensusGroup(nodes, config.longest_round, config.longest_start)
        for i in nodes:
            self._shares[i] = self.give(msg.ConsensusShare, f'consensus/node_{i}', qos.ESTIMATES)
            self._estimates[i] = (
                self.give(msg.TargetEstimate, f'estimate/consensus_{i}', qos.ESTIMATES),
                self.give(Odometry, f'odometry/consensus_{i}', qos.ESTIMATES),
            )
        for i in group.foreign:
            value = partial(_share_of, i, group.door)
            self.take(msg.ConsensusShare, f'consensus/node_{i}', value, self._heard, qos.ESTIMATES)
        self._group = group
        self._assembly.start(anchors, ids)

    def is_prepared(self) -> bool:
        """Whether the anchors are held."""
        return self._group is not None

    def _end(self, end: EpochEnd, now: float) -> None:
        self._assembly.end(end, now, lists=end.topic in self._inputs)

    def _begin(self, epoch: Epoch) -> None:
        assert self._group is not None  # the assembly starts with it
        now = time.monotonic()
        if self._group.begin(epoch):
            self._begun[epoch.request_seq] = now
        self._advance(now)

    def _heard(self, share: Share, now: float) -> None:
        assert self._group is not None  # nobody is subscribed before
        self._group.receive(share)
        self._advance(now)

    def _look_at_time(self) -> None:
        if self._group is not None:
            now = time.monotonic()
            self._group.look_at_time(now)
            self._advance(now)

    def _advance(self, now: float) -> None:
        assert self._group is not None
        for said in self._group.advance(now):
            if isinstance(said, Share):
                output = self._shares[said.node_id]
                if output.get_subscription_count():  # neighbours here have heard it already
                    output.publish(convert.share_message(said))
            else:
                self._publish(said)

    def _publish(self, estimate: Estimate) -> None:
        node = int(estimate.source.rpartition('_')[2])
        outputs = self._estimates[node]
        outputs[0].publish(convert.estimate_message(estimate))
        if outputs[1].get_subscription_count():
            outputs[1].publish(convert.odometry_message(estimate, self.config.target_height))
        assert self._group is not None  # it has just said this
        outcomes = self._outcomes.setdefault(estimate.request_seq, {})
        outcomes[node] = self._group.nodes[node].outcome
        if len(outcomes) == len(self._estimates):
            self._close(estimate)

    def _close(self, last: Estimate) -> None:
        """Every node here has finished an epoch."""
        seq = last.request_seq
        outcomes = self._outcomes.pop(seq).values()
        if self._reports.get_subscription_count():
            report = report_of(last.stamp_ns, last.target_id, seq, outcomes)
            self._reports.publish(convert_consensus.report_message(report))
        self._epoch = seq
        self._took = time.monotonic() - self._begun.pop(seq)
        self._longest = max(self._longest, self._took)
        if seq == self._assembly.final_seq:
            self.ended = True
            self.report()

    def _anew(self) -> None:
        if self._group is not None:
            self._group.reset()
        self._begun.clear()
        self._outcomes.clear()

    def _silent(self) -> list[int]:
        nodes = {} if self._group is None else self._group.nodes
        return sorted({j for node in nodes.values() for j in set(node.neighbours) - set(node.inbox.active)})

    def health(self) -> Health:
        """Requests that stopped, neighbours that fell silent."""
        return worst(super().health(), neighbours(self._silent(), self.config.silent_epochs))

    def state(self) -> Mapping[str, Any]:
        """Counts of input and shares, what is waited for, and what each node thinks of its own observation."""
        group = self._group
        nodes = {} if group is None else group.nodes
        values: dict[str, Any] = {
            'system': 'consensus',
            'epoch': self._epoch,
            'waits for': self.waits_for or (group.waits_for if group else '') or self._assembly.waits_for,
            'silent neighbours': self._silent(),
            'rounds took [s]': f'{self._took:.3f}',
            'longest [s]': f'{self._longest:.3f}',
            **self._assembly.counters,
            **{f'dropped.{reason}': n for reason, n in (group.counters if group else {}).items()},
        }
        for i, node in nodes.items():
            values[f'{i}.arrival probability'] = f'{node.arrival_probability:.4f}'
            values[f'{i}.disagreement [m]'] = f'{node.disagreement:.4f}'
        return values


def _share_of(node: int, door: Door, message: msg.ConsensusShare) -> Share:
    """The share that a message on the topic of a node holds; TrackingError where the node cannot have said it."""
    if message.node_id != node:
        raise TrackingError(f'a share of node {message.node_id}: expected those of node {node} on this topic')
    return door.check(convert.share_value(message))


def main() -> None:
    """Run the node."""
    run(ConsensusProcess)
