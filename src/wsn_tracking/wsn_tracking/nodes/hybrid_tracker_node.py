"""hybrid_tracker_node: system D, a track for every target by least squares and a Kalman filter of single ranges."""

from __future__ import annotations

from wsn_tracking_msgs import msg

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.hybrid import HybridNodeConfig
from wsn_tracking.nodes import qos
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.convert import header
from wsn_tracking.nodes.tracker import TrackerNode
from wsn_tracking.sensing.schedule import Schedule
from wsn_tracking.sensing.scheduler import CellScheduler
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.tracker import Tracker

NO_TRIGGER = {'y_min': -128, 'e_min': 0.0, 'e_max': 2.55}  # whoever measures sends


class HybridTrackerNode(TrackerNode[HybridNodeConfig]):
    """Where it is asked to, it is the base station as well: it says which nodes measure."""

    def __init__(self) -> None:
        super().__init__('hybrid_tracker_node', HybridNodeConfig)
        self._schedule: Schedule | None = None
        if self.config.schedule:
            self._commands = self.give(msg.SensingCommand, 'sensing_command', qos.ESTIMATES)

    def on_anchors(self, anchors: Anchors) -> None:
        """Make the schedule."""
        super().on_anchors(anchors)
        if self.config.schedule:
            self._schedule = Schedule(CellScheduler(anchors))

    def after(self, tracker: Tracker, epoch: Epoch) -> None:
        """Tell whoever is to measure, or to rest, from now on."""
        if self._schedule is None or not isinstance(tracker, HybridTracker):
            return
        ahead = epoch.stamp_ns + round(self.config.period * 1e9)
        for command in self._schedule.see(epoch.target_id, epoch.stamp_ns, tracker.predicted(ahead)):
            told = msg.SensingCommand(node_id=command.node_id, active=command.active, **NO_TRIGGER)
            told.header = header(epoch.stamp_ns)
            told.header.frame_id = ''
            self._commands.publish(told)


def main() -> None:
    """Run the node."""
    run(HybridTrackerNode)
