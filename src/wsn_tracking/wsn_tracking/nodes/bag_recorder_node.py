"""bag_recorder_node: writes what a replay needs, as it comes, undecoded."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Mapping
from typing import Any

from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message
from wsn_tracking_msgs import msg

from wsn_tracking.bags.types import ODOMETRY, expected_type
from wsn_tracking.bags.write import BagWriter
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.listeners import RecorderConfig
from wsn_tracking.nodes import qos
from wsn_tracking.nodes.base import Finished, TrackingNode, run

CLASSES = {
    'nav_msgs/msg/Odometry': Odometry,
    **{f'wsn_tracking_msgs/msg/{name}': getattr(msg, name) for name in dir(msg) if name[0].isupper()},
}


def _kind_of(topic: str) -> str:
    """The type of a topic by its name."""
    name = ODOMETRY if topic.startswith('odometry/') else expected_type(topic)
    if name is None:
        raise TrackingError(f'topic `{topic}` has no known type: expected rssi, truth/..., estimate/... and the like')
    return name


class BagRecorderNode(TrackingNode[RecorderConfig]):
    """Subscribes the base topics and one entry level; ends when the feed has ended and all is quiet."""

    def __init__(self) -> None:
        super().__init__('bag_recorder_node', RecorderConfig)
        config = self.config
        kinds = {topic: _kind_of(topic) for topic in self._topics()}
        entries = dict(entry.partition('=')[::2] for entry in config.metadata if entry)
        self._writer = BagWriter(config.output, {'entry_level': config.entry_level, **entries})
        self._counts: Counter[str] = Counter()
        self._listed: Counter[str] = Counter()  # what the feed says that it has sent
        self._newest: dict[int, int] = {}  # target_id -> request_seq of its last list; a repeated one asks for nothing
        self._going: set[int] = set()  # targets whose feed has not ended
        self._finals: dict[int, int] = {}  # the last epoch of each target whose feed has ended
        self._estimates = {topic: b'' for topic in kinds if topic.startswith('estimate/')}  # the last one of each
        self._ended = False
        self._last = time.monotonic()
        for topic, kind in kinds.items():
            self._record(topic, kind)
        self.create_timer(0.05, self._finish)

    def _topics(self) -> list[str]:
        level = [self.config.entry_level, *(['trigger_report'] if self.config.entry_level == 'range' else [])]
        truths = [f'truth/target_{target}' for target in self.config.targets]
        extra = [topic for topic in self.config.extra_topics if topic]
        return ['anchors', 'request', *level, 'epoch_end', *truths, *extra]

    def _record(self, topic: str, type_name: str) -> None:
        def callback(cdr: bytes) -> None:
            self._last = time.monotonic()
            self._counts[topic] += 1
            self._writer.write_raw(topic, type_name, cdr, time.time_ns())
            if topic in self._estimates:
                self._estimates[topic] = cdr
            elif topic == 'epoch_end':
                end = deserialize_message(cdr, msg.EpochEnd)
                self._listed[end.topic] += len(end.seqs)
                self._listed['request'] += self._newest.get(end.target_id) != end.request_seq
                self._newest[end.target_id] = end.request_seq
                (self._going.discard if end.final else self._going.add)(end.target_id)
                if end.final:
                    self._finals[end.target_id] = end.request_seq
                self._ended = not self._going

        profile = qos.LATCHED_LAST if topic == 'anchors' else qos.FED
        subscription = self.create_subscription(CLASSES[type_name], topic, callback, profile, raw=True)
        self._matching.subscription(subscription, topic)

    def _finish(self) -> None:
        silence = time.monotonic() - self._last
        if self._ended and silence > self.config.silence:
            # in its time, the middleware repeats what a reader that stood still has not taken; trackers may be slow
            missing = bool(self._missing or self._behind)
            if not missing or silence > self.config.loss_timeout:
                raise Finished(1 if missing else 0)

    @property
    def _missing(self) -> dict[str, int]:
        """Messages by topic that are recorded, that the feed has listed and that have not come."""
        missing = self._listed - self._counts
        return {topic: count for topic, count in missing.items() if topic in self._topics()}

    @property
    def _behind(self) -> list[str]:
        """Topics of estimates that are recorded and have not come to the last epoch of their target."""
        return [topic for topic, cdr in self._estimates.items() if not cdr or not self._is_final(cdr)]

    def _is_final(self, cdr: bytes) -> bool:
        estimate = deserialize_message(cdr, msg.TargetEstimate)
        return bool(self._finals.get(estimate.target_id) == estimate.request_seq)

    def destroy_node(self) -> None:
        """Finalise the bag, whatever ended the node."""
        try:
            self._writer.close()
            # printed, not logged: whether anybody still takes the log of an interrupted node is a matter of chance
            print(f'{self.config.output}: {dict(self._counts)}')
            for topic, count in self._missing.items():
                print(f'{topic}: {count} of {self._listed[topic]} messages have not come', file=sys.stderr)
            for topic in self._behind if self._ended else ():
                print(f'{topic} did not reach the final epoch of its target: {self._finals}', file=sys.stderr)
        finally:
            super().destroy_node()

    def state(self) -> Mapping[str, Any]:
        """Messages written by topic, and those that have not come."""
        return {**self._counts, **{f'missing.{topic}': count for topic, count in self._missing.items()}}


def main() -> None:
    """Run the node."""
    run(BagRecorderNode)
