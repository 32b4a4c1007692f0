"""bag_player_node: plays a recording into the graph, losing nothing, at any rate."""

from __future__ import annotations

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.read import read
from wsn_tracking.configuration import PlayerConfig
from wsn_tracking.errors import TrackingError
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.feed import FeedNode
from wsn_tracking.sensing.recording import Recording, of_target


class BagPlayerNode(FeedNode[PlayerConfig]):
    """Sends what a bag holds."""

    def __init__(self) -> None:
        super().__init__('bag_player_node', PlayerConfig)

    def load(self) -> Recording:
        """The bag, with an EpochEnd for every epoch."""
        if not self.config.bag:
            raise TrackingError('parameter `bag` is empty: expected a bag to play, e.g. -p bag:=bags/a_loop')
        recording = with_epoch_ends(read(self.config.bag, self.config.namespace or None))
        return of_target(recording, self.config.target_id)


def main() -> None:
    """Run the node."""
    run(BagPlayerNode)
