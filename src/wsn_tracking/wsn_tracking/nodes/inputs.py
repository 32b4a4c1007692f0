"""What measurements a node takes: the topic that it is told, or whatever somebody publishes."""

from __future__ import annotations

from typing import Any, Protocol

from wsn_tracking_msgs import msg

from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import TrackingNode

TOPICS = {
    'range': (msg.RangeMeasurement, convert.range_value),
    'rssi': (msg.RssiMeasurement, convert.rssi_value),
    'observation': (msg.RangeBearing, convert.range_bearing_value),
}
AUTO = 'auto'
LOOK = 0.2  # [s] how often it is looked who publishes


class Taker(Protocol):
    """Whoever assembles epochs."""

    def measurement(self, message: Any, now: float) -> None:
        """A measurement."""

    def listing(self, message: Any, now: float) -> None:
        """What was sent."""


def take_measurements(node: TrackingNode[Any], topic: str, assembly: Taker) -> None:
    """Subscribe a topic of measurements, and the reports of who stayed silent where there are any."""
    kind, value = TOPICS[topic]
    node.take(kind, topic, value, assembly.measurement, qos.MEASUREMENTS)
    if topic == 'range':
        node.take(msg.TriggerReport, 'trigger_report', convert.report_value, assembly.listing, qos.MEASUREMENTS)


class Input:
    """The one topic that a node takes measurements from: `topic`, empty as long as `auto` has not found one."""

    def __init__(self, node: TrackingNode[Any], wanted: str, assembly: Taker) -> None:
        self._node, self._assembly = node, assembly
        self.topic = ''
        if wanted != AUTO:
            self._choose(wanted)
        elif not self._look():
            self._timer = node.create_timer(LOOK, self._look_again)

    def _look(self) -> bool:
        offered = [topic for topic in TOPICS if self._node.count_publishers(topic)]
        if offered:
            self._choose(offered[0])
        return bool(offered)

    def _look_again(self) -> None:
        if self._look():
            self._node.destroy_timer(self._timer)

    def _choose(self, topic: str) -> None:
        self.topic = topic
        take_measurements(self._node, topic, self._assembly)
