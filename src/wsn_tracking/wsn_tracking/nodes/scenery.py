"""Fills a scene from a running graph: anchors, reports, and whatever estimates and truths somebody publishes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from wsn_tracking_msgs import msg

from wsn_tracking.bags.types import truth_target
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.nodes import convert, convert_consensus, qos
from wsn_tracking.sensing.values import TriggerReport
from wsn_tracking.trackers.consensus_report import ConsensusReport
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.viewing.scene import Scene

LOOK_EVERY = 0.5  # [s] steady time
ESTIMATE, TRUTH = 'wsn_tracking_msgs/msg/TargetEstimate', 'nav_msgs/msg/Odometry'

# kind, topic, message -> value, then(value, steady time), quality of service
Take = Callable[[type[Any], str, Callable[[Any], Any], Callable[[Any, float], None], QoSProfile], Subscription]


class Scenery:
    """Looks around for outputs; `choose` says which of their names are shown, and may change its mind."""

    def __init__(self, node: Node, scene: Scene, take: Take, choose: Callable[[Iterable[str]], Sequence[str]]) -> None:
        self.scene = scene
        self._node, self._take, self._choose = node, take, choose
        self._outputs: dict[str, Subscription] = {}
        self._targets: set[int] = set()
        take(msg.Anchors, 'anchors', convert.anchors_value, self._anchors, qos.LATCHED_LAST)
        take(msg.TriggerReport, 'trigger_report', convert.report_value, self._report, qos.DISPLAY)
        take(msg.ConsensusReport, 'consensus_report', convert_consensus.report_value, self._consensus, qos.DISPLAY)
        self._look_around()
        node.create_timer(LOOK_EVERY, self._look_around)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the estimates that are shown."""
        return tuple(sorted(self._outputs))

    def _look_around(self) -> None:
        """Follow the outputs that are chosen of those that are there, and every truth."""
        topics = dict(self._node.get_topic_names_and_types())
        lead = self._node.resolve_topic_name('estimate') + '/'
        there = [topic[len(lead) :] for topic, kinds in topics.items() if topic.startswith(lead) and ESTIMATE in kinds]
        chosen = set(self._choose(there))
        for name in self._outputs.keys() - chosen:
            self._node.destroy_subscription(self._outputs.pop(name))
            self.scene.forget(name)
        for name in sorted(chosen - self._outputs.keys()):
            self._outputs[name] = self._follow(name)
        lead = self._node.resolve_topic_name('truth').removesuffix('truth')
        for topic, kinds in topics.items():
            target = truth_target(topic.removeprefix(lead)) if topic.startswith(lead) else None
            if target is not None and TRUTH in kinds and target not in self._targets:
                self._targets.add(target)
                self._follow_truth(target)

    def _follow(self, name: str) -> Subscription:
        def heard(estimate: Estimate, now: float) -> None:
            self.scene.add_estimate(name, estimate)

        return self._take(msg.TargetEstimate, f'estimate/{name}', convert.estimate_value, heard, qos.DISPLAY)

    def _follow_truth(self, target: int) -> None:
        def heard(pose: tuple[int, Any, Any], now: float) -> None:
            self.scene.add_truth(target, pose[0], pose[1])

        self._take(Odometry, f'truth/target_{target}', convert.truth_position, heard, qos.DISPLAY)

    def _anchors(self, anchors: Anchors, now: float) -> None:
        self.scene.add_anchors(anchors)

    def _report(self, report: TriggerReport, now: float) -> None:
        self.scene.add_report(report)

    def _consensus(self, report: ConsensusReport, now: float) -> None:
        self.scene.add_consensus(report)
