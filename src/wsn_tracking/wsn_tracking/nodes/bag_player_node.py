"""bag_player_node: plays a recording into the graph, losing nothing, at any rate."""

from __future__ import annotations

from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.feeds import PlayerConfig
from wsn_tracking.nodes.base import run
from wsn_tracking.nodes.feed import FeedNode
from wsn_tracking.sensing.recording import Recording, of_target


def load(config: PlayerConfig) -> Recording:
    """The bag, with an EpochEnd for every epoch; TrackingError where there is none."""
    if not config.bag:
        raise TrackingError('parameter `bag` is empty: expected a bag to play, e.g. -p bag:=bags/a_loop')
    return of_target(with_epoch_ends(read(config.bag, config.namespace or None)), config.target_id)


def main() -> None:
    """Run the node."""
    run(lambda: FeedNode('bag_player_node', PlayerConfig, load))
