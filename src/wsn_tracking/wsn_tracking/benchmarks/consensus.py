"""Consensus of 50 nodes against a loop over neighbours, and what a node-epoch of system B costs as networks grow."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, cpu_seconds
from wsn_tracking.fusion.consensus import SCHEMES
from wsn_tracking.fusion.exchange import Exchange
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.graph import adjacency
from wsn_tracking.simulation.b_field import FieldConfig, grown
from wsn_tracking.studies.consensus_runs import sample
from wsn_tracking.trackers.consensus import Network, Nodes
from wsn_tracking.trackers.consensus_config import ConsensusConfig

GROUP, WORK = 'consensus', 'consensus, 50 nodes, 10 rounds, 20 numbers'
ROUNDS, NUMBERS = 10, 20
RUNS = 1000  # of scenario B
BLOCK = 200  # that are tracked at a time
GROWN = (10, 50, 100, 200, 400)  # nodes, at the same density

Work = Callable[[], object]


def problem(seed: int = 1) -> tuple[Mask, Floats]:
    """The graph of a field of 50 nodes, and a row of numbers for each."""
    worlds = sample(FieldConfig(epochs=1), 1, seed)
    return adjacency(worlds.positions[0], 100.0), np.random.default_rng(seed).standard_normal((50, NUMBERS))


def ours(graph: Mask, x: Floats) -> Work:
    """The matrix form: one product, its matrix kept from epoch to epoch."""
    exchange = Exchange(SCHEMES['cm'], ROUNDS, graph)
    return lambda: exchange.lossless(x, graph, graph).value


def loop(graph: Mask, x: Floats) -> Work:
    """Each round node by node, neighbour by neighbour, as it is usually written."""
    neighbours = [np.flatnonzero(row).tolist() for row in graph]

    def rounds() -> Floats:
        values = x
        for _ in range(ROUNDS):
            after = values.copy()
            for i, mine in enumerate(neighbours):
                for j in mine:
                    after[i] += (values[j] - values[i]) / (1.0 + max(len(mine), len(neighbours[j])))
            values = after
        return values

    return rounds


def scenario_b(runs: int, nodes: int = 50, epochs: int = 50) -> Work:
    """All epochs of so many runs, in blocks; the field keeps its density."""
    block = min(runs, BLOCK)
    worlds = sample(grown(FieldConfig(epochs=epochs), nodes), block, 1)

    def track() -> Nodes:
        for _ in range(max(runs // block, 1)):
            network = Network(ConsensusConfig(), worlds.positions, link_seeds=np.arange(block))
            state = network.start()
            for k in range(epochs):
                state, _ = network.step(state, k, 1.0 if k else 0.0, worlds.z[:, k], worlds.R)
        return state

    return track


def rows(sizes: Sizes) -> Iterable[Row]:
    """Matrix form against the loop, the thousand runs, and the growth."""
    graph, x = problem()
    took = cpu_seconds({'ours': ours(graph, x), 'loop': loop(graph, x)}, sizes)
    yield Row(
        GROUP, WORK, 'us', 1e6 * took['ours'], 'loop over neighbours', 1e6 * took['loop'], at_least(500.0, ratio=True)
    )
    once = sizes._replace(rounds=1, least=0.0)  # seconds each: they need no repetition
    name = f'scenario B, {RUNS} runs x 50 nodes x 50 epochs, per node-epoch'
    whole = cpu_seconds({'whole': scenario_b(RUNS)}, once)['whole']
    yield Row(GROUP, name, 'us', 1e6 * whole / (RUNS * 50 * 50))
    for nodes in GROWN:
        runs = max(4000 // nodes // 4, 2)
        seconds = cpu_seconds({'grown': scenario_b(runs, nodes, 10)}, sizes)['grown']
        yield Row(GROUP, f'scenario B with {nodes} nodes, per node-epoch', 'us', 1e6 * seconds / (runs * nodes * 10))
