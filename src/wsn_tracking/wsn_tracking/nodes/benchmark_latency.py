"""How long a message takes from publish to callback in a process of many subscriptions, under either executor.

`python -m wsn_tracking.nodes.benchmark_latency draining|stock ENTITIES MESSAGES` prints the median in milliseconds.
"""

from __future__ import annotations

import statistics
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from wsn_tracking.nodes import qos
from wsn_tracking.nodes.base import Finished
from wsn_tracking.nodes.executor import make_executor

PERIOD = 0.002  # [s] between messages


class Probe(Node):
    """Sends stamps to itself; the other subscriptions hear nothing, but every wait looks at them."""

    def __init__(self, entities: int, messages: int) -> None:
        super().__init__('probe')
        for number in range(entities):
            self.create_subscription(String, f'silent_{number}', self._hear, qos.MEASUREMENTS)
        self.create_subscription(String, 'probe', self._hear, qos.MEASUREMENTS)
        self._output = self.create_publisher(String, 'probe', qos.MEASUREMENTS)
        self.create_timer(PERIOD, self._send)
        self._messages = messages
        self.latencies: list[float] = []

    def _send(self) -> None:
        self._output.publish(String(data=str(time.monotonic_ns())))

    def _hear(self, message: String) -> None:
        self.latencies.append((time.monotonic_ns() - int(message.data)) * 1e-6)
        if len(self.latencies) >= self._messages:
            raise Finished


def main() -> None:
    """Measure and print."""
    kind, entities, messages = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    probe = Probe(entities, messages)
    if kind == 'draining':
        executor = make_executor(probe)
    else:
        executor = SingleThreadedExecutor()
        executor.add_node(probe)
    try:
        executor.spin()
    except Finished:
        print(statistics.median(probe.latencies[messages // 10 :]))  # without the first, which find the way
    probe.destroy_node()
    rclpy.try_shutdown()  # type: ignore[attr-defined]


if __name__ == '__main__':
    main()
