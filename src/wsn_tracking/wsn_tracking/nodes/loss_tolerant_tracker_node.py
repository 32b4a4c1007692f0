"""loss_tolerant_tracker_node: system E, a cubature filter of a turning target that tolerates the loss of packets."""

from __future__ import annotations

from wsn_tracking.node_parameters.loss_tolerant import LossTolerantNodeConfig
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.tracker import TrackerNode


def main() -> None:
    """Run the node."""
    run(lambda: TrackerNode('loss_tolerant_tracker_node', LossTolerantNodeConfig))
