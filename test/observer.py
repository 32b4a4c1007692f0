"""A node of the test's own that looks at a running graph."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from wsn_tracking.nodes.shared_memory import remove_unfinished

LOOK_S = 0.02  # between two looks


class Observer:
    """Spins until something is seen."""

    def __init__(self, node: Node, executor: SingleThreadedExecutor) -> None:
        self.node = node
        self._executor = executor
        self._told: dict[str, DiagnosticStatus] = {}
        node.create_subscription(DiagnosticArray, '/diagnostics', self._hear, 100)

    def until(self, seen: Callable[[], bool], timeout: float, what: str) -> None:
        """Spin until `seen`, or fail after `timeout` [s] with what the nodes said of themselves."""
        deadline = time.monotonic() + timeout
        while not seen():
            assert time.monotonic() < deadline, f'not seen within {timeout:g} s: {what}\n{self._words()}'
            # whatever came in the meantime is taken before the next look, which may be slow
            pause = time.monotonic() + LOOK_S
            while (left := pause - time.monotonic()) > 0.0:
                self._executor.spin_once(timeout_sec=left)

    def _hear(self, array: DiagnosticArray) -> None:
        self._told.update({status.name: status for status in array.status})

    def told(self, name: str) -> dict[str, str]:
        """What a node has last said of itself in /diagnostics."""
        return {pair.key: pair.value for pair in self._told[name].values} if name in self._told else {}

    def forget(self, name: str) -> None:
        """Whatever is told of a node from now on comes from the process that then runs."""
        self._told.pop(name, None)

    def _words(self) -> str:
        """Each node's last sentence and values; 'age of' tells how long ago it heard whom."""
        return '\n'.join(
            f'{name}: {status.message}; {", ".join(f"{pair.key}: {pair.value}" for pair in status.values)}'
            for name, status in sorted(self._told.items())
        )

    def until_node(self, name: str, timeout: float) -> None:
        """Spin until a node of that name is there."""
        self.until(lambda: name in self.node.get_node_names(), timeout, f'node {name}')

    def collect(self, kind: type[Any], topic: str, profile: Any) -> list[Any]:
        """A list that fills with the messages of a topic."""
        messages: list[Any] = []
        self.node.create_subscription(kind, topic, messages.append, profile)
        return messages


@contextlib.contextmanager
def observing(environment: Mapping[str, str]) -> Iterator[Observer]:
    """An observer in the domain of an environment; discovery is limited as that of this process is."""
    remove_unfinished()
    context = Context()
    rclpy.init(context=context, domain_id=int(environment['ROS_DOMAIN_ID']))
    node = rclpy.create_node('observer', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        yield Observer(node, executor)
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)
