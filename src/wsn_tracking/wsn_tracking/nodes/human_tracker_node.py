"""human_tracker_node: system C, a person who wears a node, tracked by a particle filter."""

from __future__ import annotations

import time

from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion

from wsn_tracking.node_parameters.human import HumanNodeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.tracker import TrackerNode
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.tracker import Tracker


class HumanTrackerNode(TrackerNode[HumanNodeConfig]):
    """Shows its particles, where somebody looks."""

    def __init__(self) -> None:
        super().__init__('human_tracker_node', HumanNodeConfig)
        self._particles = self.create_publisher(PoseArray, 'particles/human', qos.DISPLAY)
        self._shown = 0.0

    def after(self, tracker: Tracker, epoch: Epoch) -> None:
        """The particles, at most `particle_rate` times a second."""
        now, rate = time.monotonic(), self.config.particle_rate
        if not rate or now - self._shown < 1.0 / rate or not self._particles.get_subscription_count():
            return
        assert isinstance(tracker, HumanTracker)
        self._shown = now
        height, upright = self.config.target_height, Quaternion(w=1.0)
        places = tracker.particles.positions.tolist()
        poses = [Pose(position=Point(x=x, y=y, z=height), orientation=upright) for x, y in places]
        self._particles.publish(PoseArray(header=convert.header(epoch.stamp_ns), poses=poses))


def main() -> None:
    """Run the node."""
    run(HumanTrackerNode)
