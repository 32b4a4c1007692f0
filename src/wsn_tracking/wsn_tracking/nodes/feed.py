"""What world_node and bag_player_node share: they send a recording to the graph, at any rate, and lose nothing.

Nothing is sent before every expected node is ready. The feed stays within a window of epochs ahead of the
outputs named in `window_topics`, so that no queue grows; at rate 0 the window alone sets the pace.

Where another graph has the same names, neither's results are worth anything: a feed with `expected_nodes` waits until
no other feed is there, and ends with an error where its outputs are told by others as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from wsn_tracking_msgs import msg

from wsn_tracking.bags.messages import to_cdr
from wsn_tracking.bags.playback import Playback, playback
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.feeds import RECORDER, FeedConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import Finished, TrackingNode
from wsn_tracking.nodes.echoes import Echoes
from wsn_tracking.nodes.health import OK, Health, outputs
from wsn_tracking.nodes.progress import Bar
from wsn_tracking.nodes.window import Window
from wsn_tracking.sensing.recording import Recording

Config = TypeVar('Config', bound=FeedConfig)

TYPES = {
    'request': msg.LocationRequest,
    'rssi': msg.RssiMeasurement,
    'range': msg.RangeMeasurement,
    'observation': msg.RangeBearing,
    'epoch_end': msg.EpochEnd,
    'trigger_report': msg.TriggerReport,
}
TICK = 0.002  # [s]
LOOK = 0.05  # [s] between two looks at who is still there
APART = 'end it, or set another ROS_DOMAIN_ID'


def _watched(entry: str) -> tuple[str, int]:
    """An entry of `window_topics`: topic, or topic=target."""
    topic, separator, target = entry.partition('=')
    if separator and not (target.isdecimal() and int(target) <= 0xFFFF):
        raise TrackingError(f'`window_topics` has {entry!r}: expected topic or topic=target, e.g. estimate/fused_1=1')
    return topic, int(target) if separator else -1


class FeedNode(TrackingNode[Config]):
    """Sends the recording that `load` gives; exits with 0, or with 1 where an output fell silent."""

    def __init__(self, name: str, kind: type[Config], load: Callable[[Config], Recording]) -> None:
        super().__init__(name, kind)
        self._recording = load(self.config)
        self._playback: Playback = playback(self._recording)
        self._first_ns = self._playback.events[0].stamp_ns if self._playback.events else 0
        self._bytes = [to_cdr(event.value, event.stamp_ns) for event in self._playback.events]
        self._outputs = {topic: self._publisher(topic) for topic in self._topics()}
        self._clock_output = self.create_publisher(Clock, '/clock', qos.CLOCK)
        self._sent = 0
        self._begun: float | None = None
        self._finished: float | None = None  # when the last output was in
        self._look_at = 0.0
        self._start = time.monotonic()
        topics = {topic: target for topic, target in map(_watched, self.config.window_topics) if topic}
        self._window = Window(topics, self._playback.epochs, self.config.window, self.config.output_timeout)
        for topic in topics:
            self.take(msg.TargetEstimate, topic, convert.estimate_value, self._progress(topic), qos.ESTIMATES)
        self._echoes = Echoes(self._playback.epochs)
        self._awaited = {name for name in self.config.expected_nodes if name}
        self._in_graph = bool(self._awaited)  # whoever starts nodes by hand may feed them from several
        self.create_subscription(String, 'ready', self._heard_ready, qos.LATCHED)
        self.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST).publish(
            convert.anchors_message(self._recording.anchors, self._first_ns)
        )
        self._bar = Bar(len(self._playback.epochs)) if self.config.progress else None
        self.create_timer(TICK, self._advance)

    def _topics(self) -> list[str]:
        return sorted({event.topic for event in self._playback.events} | {'request', 'epoch_end'})

    def _publisher(self, topic: str) -> Any:
        return self.give(Odometry if topic.startswith('truth/') else TYPES[topic], topic, qos.FED)

    def _heard_ready(self, message: String) -> None:
        self._awaited.discard(message.data)

    def _progress(self, topic: str) -> Any:
        def heard(estimate: Any, now: float) -> None:
            echo = self._echoes.is_one(topic, (estimate.target_id, estimate.request_seq))
            if echo or self._begun is None:
                told = f'told epoch {estimate.request_seq} of target {estimate.target_id}'
                when = 'before that was sent' if self._begun is None else 'once more than it was sent'
                self.get_logger().error(f'{topic} {told} {when}: another graph runs here; {APART}')
                raise Finished(1)
            self._window.heard(topic, estimate.target_id, estimate.request_seq, now)
            self._advance()

        return heard

    def _advance(self) -> None:
        """Send whatever is due and inside the window."""
        now = time.monotonic()
        if self._begun is None:
            if not self._may_begin(now):
                return
            self._begun = now
            self._window.begin(now)
        for topic in self._window.silent(now):
            self.get_logger().warn(
                f'{topic} has been silent for {self.config.output_timeout:g} s: going on without waiting for it'
            )
        events = self._playback.events
        while self._sent < len(events):
            event = events[self._sent]
            if not self._is_due(event.stamp_ns, now) or not self._window.admits(event.epoch, now):
                return
            if event.topic == 'request':
                self._clock_output.publish(Clock(clock=convert.header(event.stamp_ns).stamp))
            self._outputs[event.topic].publish(self._bytes[self._sent])
            self._sent += 1
            if self._bar is not None:
                self._bar.reach(event.epoch + 1)
        if self._window.finished():
            self._finish(now)

    def _finish(self, now: float) -> None:
        """Stay until the recorder has gone: what is still under way to it would be lost with this process."""
        if self._finished is None:
            self._finished = now
            self.report()
            self._tell()
        elif now < self._look_at:
            return
        self._look_at = now + LOOK
        recorder = (RECORDER, self.get_namespace())  # one of another graph is none of ours
        waits = RECORDER in self.config.expected_nodes and recorder in self.get_node_names_and_namespaces()
        if not waits or now - self._finished > 2.0 * self.config.output_timeout:
            raise Finished(1 if self._window.given_up else 0)

    def _may_begin(self, now: float) -> bool:
        is_ready = not self._awaited and self._matching.complete()
        if is_ready and not self._others_feed():
            return True
        if now - self._start > self.config.ready_timeout:
            lacks = f'nodes {sorted(self._awaited)} are not ready {self._matching.missing()}'
            told = f'another node feeds this graph: {APART}' if is_ready else lacks
            self.get_logger().error(f'not begun: after {self.config.ready_timeout:g} s {told}')
            raise Finished(1)
        return False

    def _others_feed(self) -> bool:
        """Whether the nodes that are fed from here get requests of others, too; told once."""
        topic = self._outputs['request'].topic_name
        if not self._in_graph or self.count_publishers(topic) <= 1:
            return False
        self.get_logger().warn(f'another node publishes {topic}: not begun before it has gone; {APART}', once=True)
        return True

    def _is_due(self, stamp_ns: int, now: float) -> bool:
        if self.config.rate == 0.0 or self._begun is None:
            return True
        elapsed = (stamp_ns - self._first_ns) * 1e-9 / self.config.rate
        return now - self._begun >= elapsed

    def _tell(self) -> None:
        sent = ', '.join(f'{count} {topic}' for topic, count in self._counts().items())
        events = self._playback.events
        lasted = max(time.monotonic() - (self._begun or 0.0), 1e-9)
        simulated = (events[-1].stamp_ns - self._first_ns) * 1e-9 if events else 0.0
        self.get_logger().info(
            f'sent {len(self._playback.epochs)} epochs in {lasted:.2f} s ({simulated / lasted:.1f} x real time): {sent}'
        )

    def destroy_node(self) -> None:
        """Leave the terminal as it was."""
        if self._bar is not None:
            self._bar.close()
        super().destroy_node()

    def _counts(self) -> dict[str, int]:
        counts = dict.fromkeys(self._outputs, 0)
        for event in self._playback.events[: self._sent]:
            counts[event.topic] += 1
        return counts

    def health(self) -> Health:
        """Outputs that fell silent."""
        if self._begun is None:
            return Health(OK, f'waits for {sorted(self._awaited)} {self._matching.missing()}')
        return outputs(self._window.given_up)

    def state(self) -> Mapping[str, Any]:
        """What was sent, how far the outputs are, what the bag held and could not be used."""
        dropped = {f'dropped.{reason}': count for reason, count in self._recording.dropped.items()}
        return {'sent messages': self._sent, 'of': len(self._playback.events), **self._window.state(), **dropped}
