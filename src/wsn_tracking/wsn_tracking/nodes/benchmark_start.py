"""How long a node takes until it is ready, against one that does nothing.

`python -m wsn_tracking.nodes.benchmark_start WORDS...` starts a node by these words and prints, once it has published
`ready`, the seconds that passed and the CPU seconds that it took. `bare` is that other node, which knows the same
messages.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from wsn_tracking_msgs import msg

from wsn_tracking.nodes import qos

TIMEOUT = 30.0  # [s]


def bare() -> None:
    """A node that is ready as soon as it exists."""
    rclpy.init()
    node = Node('bare')
    node.create_publisher(String, 'ready', qos.LATCHED).publish(String(data='bare'))
    rclpy.spin(node)


def measure(words: list[str]) -> None:
    """Start, wait for `ready`, end, print."""
    from wsn_tracking.nodes.convert import anchors_message
    from wsn_tracking.simulation.scenarios import scenario

    rclpy.init()
    node = Node('starter')
    ready: list[str] = []

    def heard(message: String) -> None:
        ready.append(message.data)

    node.create_subscription(String, 'ready', heard, qos.LATCHED)
    anchors = node.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST)
    anchors.publish(anchors_message(scenario('a_loop').anchors, 0))
    began = time.monotonic()
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL)  # here stand figures alone
    while not ready and process.poll() is None and time.monotonic() - began < TIMEOUT:
        rclpy.spin_once(node, timeout_sec=0.1)
    took = time.monotonic() - began
    process.send_signal(signal.SIGKILL)
    usage = os.wait4(process.pid, 0)[2]
    if not ready:
        sys.exit(f'{words[0]} was not ready after {took:.1f} s')
    print(took, usage.ru_utime + usage.ru_stime)


if __name__ == '__main__':
    measure(sys.argv[1:])
