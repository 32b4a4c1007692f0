"""world_node: a simulated target and its radios, in place of a real sink."""

from __future__ import annotations

import time

from wsn_tracking.configuration import WorldConfig
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.feed import FeedNode
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario


class WorldNode(FeedNode[WorldConfig]):
    """Sends what a scenario's radios say."""

    def __init__(self) -> None:
        super().__init__('world_node', WorldConfig)

    def load(self) -> Recording:
        """The scenario, stamped from now on or from where `start_stamp` says."""
        start = self.config.start_stamp or time.time()
        return record(scenario(self.config.scenario, seed=self.config.seed), self.config.seed, round(start * 1e9))


def main() -> None:
    """Run the node."""
    run(WorldNode)
