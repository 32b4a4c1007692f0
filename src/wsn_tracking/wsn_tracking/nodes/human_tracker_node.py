"""human_tracker_node: system C, a person who wears a node, tracked by a particle filter."""

from __future__ import annotations

import math
import time

from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion
from wsn_tracking_msgs import msg

from wsn_tracking.node_parameters.human import HumanNodeConfig
from wsn_tracking.nodes import convert, convert_human, qos
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.tracker import TrackerNode
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.tracker import Tracker


class HumanTrackerNode(TrackerNode[HumanNodeConfig]):
    """Tells what it knows beside its estimates, and shows its particles, where somebody looks."""

    def __init__(self) -> None:
        super().__init__('human_tracker_node', HumanNodeConfig)
        self._reports = self.create_publisher(msg.HumanReport, 'human_report', qos.MEASUREMENTS)
        self._particles = self.create_publisher(PoseArray, 'particles/human', qos.DISPLAY)
        self._shown = 0.0

    def after(self, tracker: Tracker, epoch: Epoch) -> None:
        """A report of every epoch; the particles at most `particle_rate` times a second."""
        assert isinstance(tracker, HumanTracker)
        report = tracker.report() if self._reports.get_subscription_count() else None
        if report is not None:
            self._reports.publish(convert_human.report_message(report))
        now, rate = time.monotonic(), self.config.particle_rate
        if not rate or now - self._shown < 1.0 / rate or not self._particles.get_subscription_count():
            return
        self._shown = now
        height, (places, facing, _) = self.config.target_height, tracker.equal_particles()
        poses = [
            Pose(position=Point(x=x, y=y, z=height), orientation=Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2)))
            for (x, y), yaw in zip(places.tolist(), facing.tolist(), strict=True)
        ]
        self._particles.publish(PoseArray(header=convert.header(epoch.stamp_ns), poses=poses))


def main() -> None:
    """Run the node."""
    run(HumanTrackerNode)
