"""What all nodes share: parameters from a configuration class, anchors, readiness, diagnostics, a clean end."""

from __future__ import annotations

import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, Generic, TypeVar

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.signals import uninstall_signal_handlers
from rclpy.subscription import Subscription
from rclpy.timer import Timer
from std_msgs.msg import String
from wsn_tracking_msgs import msg

from wsn_tracking.errors import TrackingError
from wsn_tracking.lifeline import follow
from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.declaring import declare, qos_overrides, warn_of_strangers
from wsn_tracking.nodes.executor import make_executor
from wsn_tracking.nodes.health import Health, flow
from wsn_tracking.nodes.matching import Matching
from wsn_tracking.nodes.refusals import REFUSALS, one_line
from wsn_tracking.nodes.shared_memory import remove_unfinished

Config = TypeVar('Config')


class Finished(Exception):
    """A node has done its work; the exit code says how it went."""

    def __init__(self, code: int = 0) -> None:
        super().__init__(code)
        self.code = code


class TrackingNode(Node, Generic[Config]):
    """A node with a configuration, that says when it is ready and, at 1 Hz, how it is."""

    def __init__(self, name: str, kind: type[Config]) -> None:
        super().__init__(name)
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.config: Config = declare(self, kind)
        self._common: NodeConfig = declare(self, NodeConfig)
        warn_of_strangers(self)
        self._overrides = qos_overrides(self)
        self._matching = Matching(self._common)
        self.ended = False  # whether the feed has ended
        self._said_ready = False
        self._ready = self.create_publisher(String, 'ready', qos.LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self.anchors: Anchors | None = None
        self._other_anchors = 0
        self.malformed: Counter[str] = Counter()
        self._last_input: dict[str, float] = {}
        self._made_at = time.monotonic()
        self._awaited_words = ''  # what it waits for, as the terminal was told
        self.create_timer(1.0, self.report)
        self._ready_timer = self.create_timer(0.05, self._check_ready)

    # ---- for subclasses

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], None],
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Of steady time, also where `use_sim_time` is set: simulated time stands still until the feed begins."""
        return super().create_timer(timer_period_sec, callback, callback_group, clock or self._steady, autostart)

    def take(
        self,
        kind: type[Any],
        topic: str,
        value: Callable[[Any], Any],
        then: Callable[[Any, float], None],
        profile: QoSProfile,
    ) -> Subscription:
        """Subscribe: each message goes to `then` as a value with the steady time; a malformed one is counted."""

        def callback(message: Any) -> None:
            now = time.monotonic()
            self._last_input[topic] = now
            try:
                arrived = value(message)
            except TrackingError as error:
                self.malformed[topic] += 1
                self.get_logger().warn(f'{topic}: {error}', throttle_duration_sec=5.0)
                return
            then(arrived, now)

        made = self.create_subscription(kind, topic, callback, profile, qos_overriding_options=self._overrides)
        return self._matching.subscription(made, topic)

    def give(self, kind: type[Any], topic: str, profile: QoSProfile) -> Publisher:
        """Publish on a topic that others may wait for."""
        made = self.create_publisher(kind, topic, profile, qos_overriding_options=self._overrides)
        return self._matching.publisher(made, topic)

    def take_anchors(self) -> None:
        """Subscribe the latched table."""
        self.take(msg.Anchors, 'anchors', convert.anchors_value, self._hold_anchors, qos.LATCHED_LAST)

    def on_anchors(self, anchors: Anchors) -> None:
        """The table is held: the first one, as long as the node lives."""

    def is_prepared(self) -> bool:
        """Whether the node could work if its inputs came; a subclass adds what it needs."""
        return True

    def health(self) -> Health:
        """Level and sentence for /diagnostics; a subclass adds its own conditions with `worst`."""
        last = self._last_input.get('request', self._last_input.get('epoch_end'))
        age = None if last is None else time.monotonic() - last
        return flow(age, self.ended, self._common.silence_timeout)

    def state(self) -> Mapping[str, Any]:
        """Values for /diagnostics."""
        return {}

    def report(self) -> None:
        """Publish one DiagnosticArray."""
        level, sentence = self.health()
        values = self.state()
        now = time.monotonic()
        ages = {f'age of {topic} [s]': f'{now - then:.2f}' for topic, then in self._last_input.items()}
        wrong = {f'malformed.{topic}': count for topic, count in self.malformed.items()}
        other = {'dropped.other_anchors': self._other_anchors} if self._other_anchors else {}
        pairs = {**values, **other, **wrong, **ages}
        status = DiagnosticStatus(
            level=level,
            name=self.get_fully_qualified_name(),
            message=sentence,
            hardware_id='',
            values=[KeyValue(key=k, value=str(v)) for k, v in pairs.items()],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)
        self._say_awaited(values.get('waits for', ''))

    # ---- within

    def _say_awaited(self, waits_for: str) -> None:
        """Whoever starts a node on its own sees what it waits for, as long as no request has come."""
        patient = time.monotonic() - self._made_at < self._common.silence_timeout
        if patient or 'request' in self._last_input or waits_for in {'', self._awaited_words}:
            return
        self._awaited_words = waits_for
        self.get_logger().info(f'waits for {waits_for}')

    def _hold_anchors(self, anchors: Anchors, now: float) -> None:
        if self.anchors is None:
            self.anchors = anchors
            self.on_anchors(anchors)
        elif not all(map(np.array_equal, anchors, self.anchors)):
            self._other_anchors += 1
            self.get_logger().warn('another table of anchors is ignored: the first one counts until a new start')

    def _check_ready(self) -> None:
        if self.is_prepared() and self._matching.complete():
            self._ready.publish(String(data=self.get_name()))
            self._said_ready = True
            self._ready_timer.cancel()

    @property
    def waits_for(self) -> str:
        """What the node still waits for before it is ready, in words; empty when it is."""
        if self._said_ready:
            return ''
        return 'anchors' if not self.is_prepared() else self._matching.missing()


def run(make: Callable[[], TrackingNode[Any]]) -> None:
    """Spin a node until it is finished, interrupted or told to stop; what is wrong at its start is told in one line."""
    follow()
    remove_unfinished()
    code, begun, node, executor = 0, False, None, None
    try:
        rclpy.init()
        begun = True
        node = make()
        executor = make_executor(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Finished as finished:
        code = finished.code
    except (TrackingError, OSError) as error:
        code = _told(str(error))
    except Exception as error:
        # where a signal has shut the context down while the node was being made, that is an end like any other
        if not begun or rclpy.ok():  # type: ignore[attr-defined]
            if node is not None or not isinstance(error, REFUSALS):
                raise
            code = _told(one_line(error))
    finally:
        uninstall_signal_handlers()  # their thread may still wake the executor, which therefore lives on so far
        for number in (signal.SIGINT, signal.SIGTERM):  # the end has begun: a second request must not break it
            signal.signal(number, signal.SIG_IGN)
        del executor
        if node is not None:
            code = _ended(node, code)
        rclpy.try_shutdown()  # type: ignore[attr-defined]
    sys.exit(code)


def _told(error: str) -> int:
    """The exit code of an error, which has been told."""
    print(f'error: {error}', file=sys.stderr)
    return 2


def _ended(node: TrackingNode[Any], code: int) -> int:
    """The exit code once a node has cleaned up; what goes wrong then is told unless it went wrong before."""
    try:
        node.destroy_node()
    except TrackingError as error:
        return code or _told(str(error))
    return code
