"""estimator_node: one estimator of system A, its local filter and its fusion with its peers'."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping
from typing import Any

from nav_msgs.msg import Odometry
from wsn_tracking_msgs import msg

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.assembly import TICK, Assembly
from wsn_tracking.nodes.base import TrackingNode, run
from wsn_tracking.nodes.health import Health, peers, worst
from wsn_tracking.nodes.inputs import Input
from wsn_tracking.sensing.channel_file import check_channel
from wsn_tracking.sensing.values import Epoch, EpochEnd
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.estimator import make_estimator
from wsn_tracking.trackers.fusing import Fuser
from wsn_tracking.trackers.gate import FusionGate
from wsn_tracking.trackers.random_q import LocalEstimator


class EstimatorNode(TrackingNode[EstimatorNodeConfig]):
    """Feeds a LocalEstimator with epochs, publishes its estimates, fuses them with the peers' of the same epoch."""

    def __init__(self) -> None:
        super().__init__('estimator_node', EstimatorNodeConfig)
        self.config.checked()
        check_channel(self.config.channel)
        config = self.config
        self._gate = FusionGate(config.id, config.all_peers, config.fusion_timeout)
        self._parts: tuple[LocalEstimator, Fuser] | None = None
        self._queue: deque[Epoch] = deque()
        self._fused_seq = -1
        self._assembly = Assembly(self, config, self._enqueue, self._anew)
        self._local = self._outputs(f'local_{config.id}')
        self._fused = self._outputs(f'fused_{config.id}')
        for peer in self._gate.peers:
            self._take_peer(peer)
        self._input = Input(self, config.input, self._assembly)
        self.take(msg.LocationRequest, 'request', convert.request_value, self._assembly.request, qos.MEASUREMENTS)
        self.take(msg.EpochEnd, 'epoch_end', convert.epoch_end_value, self._end, qos.MEASUREMENTS)
        self.take_anchors()
        self.create_timer(TICK, self._advance)

    def _outputs(self, name: str) -> tuple[Any, Any]:
        return (
            self.give(msg.TargetEstimate, f'estimate/{name}', qos.ESTIMATES),
            self.give(Odometry, f'odometry/{name}', qos.ESTIMATES),
        )

    def _take_peer(self, peer: int) -> None:
        def heard(estimate: Estimate, now: float) -> None:
            self._gate.peer_estimate(peer, estimate)
            self._advance()

        self.take(msg.TargetEstimate, f'estimate/local_{peer}', convert.peer_value, heard, qos.ESTIMATES)

    def on_anchors(self, anchors: Anchors) -> None:
        """Make the filter."""
        self._parts = make_estimator(self.config, anchors)
        self._assembly.start(anchors, self._parts[0].table.anchors.ids.tolist())

    def is_prepared(self) -> bool:
        """Whether the anchors are held and the input is chosen."""
        return self._parts is not None and bool(self._input.topic)

    def _end(self, end: EpochEnd, now: float) -> None:
        self._assembly.end(end, now, lists=end.topic == self._input.topic)

    def _enqueue(self, epoch: Epoch) -> None:
        self._queue.append(epoch)
        self._advance()

    def _advance(self) -> None:
        """Filter and fuse whatever can be by now; with feedback, a fusion comes before the next filter step."""
        assert self._parts is not None or not self._queue
        while self._parts is not None:
            local, fuser = self._parts
            fused = self._fuse(local, fuser)
            held = self.config.fusion.feedback and self._gate.waiting
            if not self._queue or held:
                if not fused:
                    return
                continue
            estimate = local.step(self._queue.popleft())
            self._publish(self._local, estimate)
            self._gate.own_estimate(estimate, time.monotonic())

    def _fuse(self, local: LocalEstimator, fuser: Fuser) -> bool:
        ready = self._gate.ready(time.monotonic())
        for estimates in ready:
            fused = fuser.step(estimates)
            if self.config.fusion.feedback:
                local.feed_back(fused)
            self._publish(self._fused, fused)
            self._fused_seq = fused.request_seq
            if fused.request_seq == self._assembly.final_seq:
                self.ended = True
                self.report()
        return bool(ready)

    def _publish(self, outputs: tuple[Any, Any], estimate: Estimate) -> None:
        outputs[0].publish(convert.estimate_message(estimate))
        if outputs[1].get_subscription_count():  # costs as much as the filter, mostly for nobody
            outputs[1].publish(convert.odometry_message(estimate, self.config.target_height))

    @property
    def _hears(self) -> str:
        """The nodes that this estimator listens to."""
        return '' if self._parts is None else ' '.join(map(str, self._parts[0].table.anchors.ids.tolist()))

    def _local_counters(self) -> dict[str, int]:
        counters = {} if self._parts is None else self._parts[0].counters
        return {name if name != 'gated' else 'dropped.gated': count for name, count in counters.items()}

    def _anew(self) -> None:
        if self._parts is not None:
            self._parts[0].reset()
            self._parts[1].reset()
        self._gate.reset()
        self._queue.clear()

    def health(self) -> Health:
        """Requests that stopped, peers that fell silent."""
        return worst(super().health(), peers(self._gate.absent))

    def state(self) -> Mapping[str, Any]:
        """Counts of input, the peers that are missing, and what is waited for."""
        return {
            'epoch': self._fused_seq,
            'system': 'random_q',
            'input': self._input.topic,
            'waits for': self.waits_for or self._assembly.waits_for,
            'absent peers': list(self._gate.absent),
            'hears': self._hears,
            **self._local_counters(),
            **self._assembly.counters,
            **self._gate.counters,
        }


def main() -> None:
    """Run the node."""
    run(EstimatorNode)
