"""Parameters of what feeds a graph: world_node and bag_player_node."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.parameters import param

RECORDER = 'bag_recorder'  # the node that a feed outlives, if it expects one


@dataclass(frozen=True)
class FeedConfig:
    """How world_node and bag_player_node feed a graph."""

    rate: float = param(1.0, 'speed, as a multiple of real time; 0: as fast as the outputs keep up', '', 0.0, 1e6)
    expected_nodes: tuple[str, ...] = param(
        ('',), 'names of the nodes that must be ready before anything is sent; empty: none'
    )
    window_topics: tuple[str, ...] = param(('',), 'outputs that the feed stays close to, each as topic or topic=target')
    window: int = param(4, 'epochs that the feed may be ahead of those outputs', '', 1, 100000)
    output_timeout: float = param(5.0, 'an output silent for so long leaves the window', 's', 1e-2, 3600.0)
    progress: bool = param(False, 'draw a progress bar on the terminal')
    ready_timeout: float = param(60.0, 'how long nodes may take to be ready', 's', 1e-2, 86400.0)


@dataclass(frozen=True)
class PlayerConfig(FeedConfig):
    """bag_player_node."""

    bag: str = param('', 'bag to play: a rosbag2 folder or an .mcap file')
    namespace: str = param('', 'namespace in the bag, where it holds several')
    target_id: int = param(-1, 'the one target whose messages are played; -1: all', 'id', -1, 65535)


@dataclass(frozen=True)
class WorldConfig(FeedConfig):
    """world_node."""

    scenario: str = param('a_loop', 'experiment to simulate')
    seed: int = param(0, 'of the radio noise, and of a walk that is drawn', '', 0)
    settings: tuple[str, ...] = param(
        ('',), 'parameters of the scenario, name=value each, e.g. faults=clutter (docs/consensus.md, `Faults`)'
    )
    start_stamp: float = param(0.0, 'stamp of the first epoch since 1970; 0: now', 's', 0.0, 4e9)
