"""world_node: a simulated target and its radios, in place of a real sink."""

from __future__ import annotations

import time

from wsn_tracking.node_parameters.feeds import WorldConfig
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.feed import FeedNode
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario, settings_of


def load(config: WorldConfig) -> Recording:
    """What the scenario's radios say, stamped from now on or from where `start_stamp` says."""
    start = config.start_stamp or time.time()
    return record(scenario(config.scenario, settings_of(config.settings), config.seed), config.seed, round(start * 1e9))


def main() -> None:
    """Run the node."""
    run(lambda: FeedNode('world_node', WorldConfig, load))
