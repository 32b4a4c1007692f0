"""What the nodes share that track by themselves: epochs in, estimates out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from nav_msgs.msg import Odometry
from rclpy.publisher import Publisher
from wsn_tracking_msgs import msg

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import TrackingNode
from wsn_tracking.nodes.inputs import Input
from wsn_tracking.nodes.tracks import Tracks
from wsn_tracking.sensing.values import Epoch, EpochEnd
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.tracker import Tracker

Config = TypeVar('Config', bound=TrackerNodeConfig)


class TrackerNode(TrackingNode[Config]):
    """Feeds the tracker of each target with epochs, and publishes what it says."""

    def __init__(self, name: str, kind: type[Config]) -> None:
        super().__init__(name, kind)
        self.config.checked().check_files()
        self._outputs: dict[str, tuple[Publisher, Publisher]] = {}
        for target in self.config.expected_targets:
            for output in self.config.outputs(target):
                self._output(output)
        self.tracks = Tracks(self, self.config, self._step)
        self.input = Input(self, self.config.input, self.tracks)
        self.take(msg.LocationRequest, 'request', convert.request_value, self.tracks.request, qos.MEASUREMENTS)
        self.take(msg.EpochEnd, 'epoch_end', convert.epoch_end_value, self._end, qos.MEASUREMENTS)
        self.take_anchors()

    def on_anchors(self, anchors: Anchors) -> None:
        """Make the trackers."""
        self.tracks.start(anchors)

    def is_prepared(self) -> bool:
        """Whether the anchors are held and the input is chosen."""
        return self.anchors is not None and bool(self.input.topic)

    def after(self, tracker: Tracker, epoch: Epoch) -> None:
        """An epoch is done: a subclass shows what is in the tracker."""

    def _output(self, name: str) -> tuple[Publisher, Publisher]:
        if name not in self._outputs:
            self._outputs[name] = (
                self.give(msg.TargetEstimate, f'estimate/{name}', qos.ESTIMATES),
                self.give(Odometry, f'odometry/{name}', qos.ESTIMATES),
            )
        return self._outputs[name]

    def _end(self, end: EpochEnd, now: float) -> None:
        self.tracks.end(end, now, lists=end.topic == self.input.topic)
        self._look_at_end()

    def _step(self, tracker: Tracker, epoch: Epoch) -> None:
        for estimate in tracker.step(epoch):
            self._publish(estimate)
        self.after(tracker, epoch)
        self._look_at_end()

    def _publish(self, estimate: Estimate) -> None:
        estimates, odometry = self._output(estimate.source)
        estimates.publish(convert.estimate_message(estimate))
        if odometry.get_subscription_count():  # costs as much as the filter, mostly for nobody
            odometry.publish(convert.odometry_message(estimate, self.config.target_height))

    def _look_at_end(self) -> None:
        if self.tracks.have_ended and not self.ended:
            self.ended = True
            self.report()

    def state(self) -> Mapping[str, Any]:
        """Counts of input, what is waited for, and how each tracker is."""
        values: dict[str, Any] = {
            'system': self.config.system,
            'epoch': self.tracks.last_seq,
            'input': self.input.topic,
            'waits for': self.waits_for or self.tracks.waits_for,
            **self.tracks.counters,
        }
        for target, track in self.tracks.by_target.items():
            lead = f'{target}.' if self.config.several else ''
            own = {} if track.tracker is None else track.tracker.state()
            values.update({f'{lead}{name}': value for name, value in own.items()})
        return values
