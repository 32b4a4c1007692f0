"""When measurements and estimates of a serial line arrive at a process of their own.

`python -m wsn_tracking.nodes.benchmark_serial FILE NODES OUTPUTS COUNT EPOCHS` says `ready` when the NODES are, and
ends when it has heard COUNT measurements and an estimate an epoch of each of the OUTPUTS, or nothing more for a while.
FILE then holds as JSON: `rssi` [node, seq, steady time in ns], for each output [contributors, measurements] an
estimate, and the last counters of the link.
"""

from __future__ import annotations

import json
import sys
import time
from functools import partial
from pathlib import Path

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from wsn_tracking_msgs import msg

from wsn_tracking.nodes import qos
from wsn_tracking.nodes.base import Finished
from wsn_tracking.nodes.executor import make_executor

SILENCE = 10.0  # [s] after which nothing more will come
LOOK = 0.1  # [s]


class Listener(Node):
    """Notes what comes."""

    def __init__(self, nodes: list[str], outputs: list[str], count: int, epochs: int) -> None:
        super().__init__('listener')
        self.rssi: list[tuple[int, int, int]] = []
        self.estimates: dict[str, list[tuple[int, int]]] = {output: [] for output in outputs}
        self.counters: dict[str, int] = {}
        self._awaited = set(nodes)
        self._count, self._epochs = count, epochs
        self._last = float('inf')
        self.create_subscription(String, 'ready', self._ready, qos.LATCHED)
        self.create_subscription(msg.RssiMeasurement, 'rssi', self._take_rssi, qos.MEASUREMENTS)
        self.create_subscription(msg.LinkStatus, 'link_status', self._take_status, qos.LATCHED_LAST)
        for output in outputs:
            taken = partial(self._take_estimate, output)
            self.create_subscription(msg.TargetEstimate, f'estimate/{output}', taken, qos.ESTIMATES)
        self.create_timer(LOOK, self._look)

    def _ready(self, message: String) -> None:
        if self._awaited:
            self._awaited.discard(message.data)
            if not self._awaited:
                print('ready', flush=True)

    def _take_rssi(self, message: msg.RssiMeasurement) -> None:
        self.rssi.append((message.node_id, message.seq, time.monotonic_ns()))
        self._last = time.monotonic()

    def _take_status(self, message: msg.LinkStatus) -> None:
        self.counters = dict(zip(message.counter_names, map(int, message.counters), strict=True))

    def _take_estimate(self, output: str, message: msg.TargetEstimate) -> None:
        self.estimates[output].append((len(message.contributors), len(message.measurements)))
        self._last = time.monotonic()

    def _look(self) -> None:
        shortest = min(map(len, self.estimates.values()))
        told = self.counters.get('reports', 0) >= self._count
        if (told and len(self.rssi) >= self._count and shortest >= self._epochs) or self._silent():
            raise Finished

    def _silent(self) -> bool:
        return time.monotonic() - self._last > SILENCE


def main() -> None:
    """Listen and write."""
    file, nodes, outputs, count, epochs = sys.argv[1:]
    rclpy.init()
    listener = Listener(nodes.split(','), outputs.split(','), int(count), int(epochs))
    try:
        make_executor(listener).spin()
    except Finished:
        heard = {'rssi': listener.rssi, 'estimates': listener.estimates, 'counters': listener.counters}
        Path(file).write_text(json.dumps(heard), 'utf-8')
    listener.destroy_node()
    rclpy.try_shutdown()  # type: ignore[attr-defined]


if __name__ == '__main__':
    main()
