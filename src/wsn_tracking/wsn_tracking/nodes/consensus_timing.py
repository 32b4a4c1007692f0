"""How long an epoch of system B takes in a running graph, from its request to the last node's estimate.

`python -m wsn_tracking.nodes.consensus_timing EPOCHS ID...` looks on, and prints a list of seconds as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter

import rclpy
from rclpy.node import Node
from wsn_tracking_msgs import msg

from wsn_tracking.nodes import qos
from wsn_tracking.nodes.base import Finished
from wsn_tracking.nodes.executor import make_executor


class Timing(Node):
    """Takes requests and all estimates; steady time throughout."""

    def __init__(self, epochs: int, ids: list[int]) -> None:
        super().__init__('consensus_timing')
        self._last_seq, self._nodes = epochs - 1, len(ids)
        self._asked: dict[int, float] = {}
        self._told: Counter[int] = Counter()
        self.took: dict[int, float] = {}
        self.create_subscription(msg.LocationRequest, 'request', self._request, qos.MEASUREMENTS)
        for i in ids:
            self.create_subscription(msg.TargetEstimate, f'estimate/consensus_{i}', self._estimate, qos.ESTIMATES)

    def _request(self, message: msg.LocationRequest) -> None:
        self._asked.setdefault(message.seq, time.monotonic())

    def _estimate(self, message: msg.TargetEstimate) -> None:
        seq = message.request_seq
        self._told[seq] += 1
        if self._told[seq] == self._nodes and seq in self._asked:
            self.took[seq] = time.monotonic() - self._asked[seq]
        if seq == self._last_seq and self._told[seq] == self._nodes:
            raise Finished


def main() -> None:
    """Look on until the last epoch, and print."""
    epochs, *ids = map(int, sys.argv[1:])
    rclpy.init()
    timing = Timing(epochs, ids)
    try:
        make_executor(timing).spin()
    except Finished:
        print(json.dumps([round(timing.took[seq], 6) for seq in sorted(timing.took)]), flush=True)
    timing.destroy_node()
    rclpy.try_shutdown()  # type: ignore[attr-defined]


if __name__ == '__main__':
    main()
