"""Looks at a running graph for `wsn-tracking watch`: no executable, and nobody waits for it."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.validate_namespace import validate_namespace

from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes.refusals import one_line
from wsn_tracking.nodes.scenery import Scenery
from wsn_tracking.nodes.shared_memory import remove_unfinished
from wsn_tracking.viewing.scene import Scene

BREATH = 0.05  # [s]


class Watcher:
    """A scene that fills while it is spun."""

    def __init__(self, node: Node, scene: Scene, choose: Callable[[Iterable[str]], Sequence[str]]) -> None:
        self.scene = scene
        self.malformed: Counter[str] = Counter()
        self._heard: float | None = None
        self._node = node
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        Scenery(node, scene, self._take, choose)

    @property
    def silence(self) -> float | None:
        """Seconds since the last message; None before the first."""
        return None if self._heard is None else time.monotonic() - self._heard

    def spin(self, seconds: float, breathe: Callable[[], None] | None = None) -> bool:
        """Take what comes for so long, and `breathe` now and then; False when the program is to end."""
        deadline = time.monotonic() + seconds
        while self._node.context.ok():
            left = deadline - time.monotonic()
            if left <= 0.0:
                return True
            self._executor.spin_once(timeout_sec=left if breathe is None else min(left, BREATH))
            if breathe is not None:
                breathe()
        return False

    def _take(
        self,
        kind: type[Any],
        topic: str,
        value: Callable[[Any], Any],
        then: Callable[[Any, float], None],
        profile: QoSProfile,
    ) -> Subscription:
        def callback(message: Any) -> None:
            try:
                arrived = value(message)
            except TrackingError:
                self.malformed[topic] += 1
                return
            self._heard = time.monotonic()
            then(arrived, self._heard)

        return self._node.create_subscription(kind, topic, callback, profile)


@contextmanager
def watching(scene: Scene, choose: Callable[[Iterable[str]], Sequence[str]], namespace: str = '') -> Iterator[Watcher]:
    """A watcher in the domain and namespace of a graph; an interrupt ends the block as if it were at its end."""
    try:
        validate_namespace(f'/{namespace.strip("/")}')
    except NameValidationException as error:
        raise TrackingError(one_line(error)) from error
    remove_unfinished()
    rclpy.init()
    node = rclpy.create_node(f'watch_{os.getpid()}', namespace=namespace)
    try:
        yield Watcher(node, scene, choose)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()  # type: ignore[attr-defined]
