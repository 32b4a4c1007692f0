"""hybrid_tracker_node: system D, a track for every target by least squares and a Kalman filter of single ranges."""

from __future__ import annotations

from wsn_tracking.node_parameters.hybrid import HybridNodeConfig
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.tracker import TrackerNode


def main() -> None:
    """Run the node."""
    run(lambda: TrackerNode('hybrid_tracker_node', HybridNodeConfig))
