"""System B over many runs at once: fields, walks and readings are drawn, every node tracks, errors are scored.

Variants are compared over the same `Worlds`, so that their difference is theirs alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.graph import adjacency, reached
from wsn_tracking.simulation import b_field
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.trackers.consensus import Network, Nodes
from wsn_tracking.trackers.consensus_config import ConsensusConfig

SETTLED = 5  # epochs that are not scored
HEADER, SHARE, ITEM = 8, 56, 10  # [bytes] the nominal model: a broadcast, 14 numbers of 4 bytes, a forwarded item
NUMBERS, ID = 14, 2  # of a share and of an item as they are sent here: in double precision, and an item's id


class Worlds(NamedTuple):
    """What happened in every run."""

    positions: Floats  # (runs, N, 3) [m]
    states: Floats  # (runs, K, 4)
    z: Floats  # (runs, K, N, 2)
    arrived: Mask  # (runs, K, N)
    R: Floats  # (2, 2)


class Scores(NamedTuple):
    """How every node of every run did, (runs, K, N); NaN where a node is dead."""

    squares: Floats  # [m^2] of the position
    nees: Floats  # of all four states: 4 on the average is consistent
    right: Floats  # 1 where the node knew whether its reading was one


def sample(config: FieldConfig, runs: int, seed: int) -> Worlds:
    """Draw runs: a field, a walk and readings each."""
    generator = np.random.default_rng(seed)
    positions = b_field.fields(config, runs, generator)
    states = b_field.walks(config, runs, generator)
    arrived = b_field.arrivals(config, generator.random((runs, config.epochs, config.nodes)))
    readings = b_field.read(config, positions[:, None], states, arrived, b_field.draw(generator, arrived.shape))
    R = np.diag(np.square([config.range_std, config.bearing_std]))
    return Worlds(positions, states, readings.z, arrived, R)


def some(worlds: Worlds, runs: Mask | slice) -> Worlds:
    """Only these runs."""
    return Worlds(worlds.positions[runs], worlds.states[runs], worlds.z[runs], worlds.arrived[runs], worlds.R)


def steps(
    config: ConsensusConfig, worlds: Worlds, alive: Mask | None = None, prior: Belief | None = None
) -> Iterator[Nodes]:
    """All nodes (runs, N) after each epoch of T = 1 s; alive (K, N), by default all; prior (runs, N, 4)."""
    runs, epochs = worlds.states.shape[:2]
    network = Network(config, worlds.positions, link_seeds=np.arange(runs))
    nodes = network.start(prior)
    for k in range(epochs):
        living = None if alive is None else np.broadcast_to(alive[k], nodes.mu.shape)
        z = worlds.z[:, k] if living is None else np.where(living[..., None], worlds.z[:, k], np.nan)
        nodes, _ = network.step(nodes, k, 1.0 if k else 0.0, z, worlds.R, living)
        yield nodes


def track(config: ConsensusConfig, worlds: Worlds, alive: Mask | None = None, prior: Belief | None = None) -> Scores:
    """Every node of every run through all epochs, see `steps`, scored."""
    squares, normed, right = (np.empty(worlds.arrived.shape) for _ in range(3))
    for k, nodes in enumerate(steps(config, worlds, alive, prior)):
        e = nodes.belief.m - worlds.states[:, k, None]
        squares[:, k] = np.sum(e[..., :2] ** 2, axis=-1)
        normed[:, k] = nees(e, nodes.belief.P)
        right[:, k] = (nodes.mu > 0.5) == worlds.arrived[:, k]
        if alive is not None:
            for score in (squares, normed, right):
                score[:, k][~np.broadcast_to(alive[k], nodes.mu.shape)] = np.nan
    return Scores(squares, normed, right)


def rmse(scores: Scores, epochs: slice = slice(SETTLED, None)) -> float:
    """Root of the mean squared position error over runs, epochs and nodes [m]."""
    return float(np.sqrt(np.nanmean(scores.squares[:, epochs])))


def mean_nees(scores: Scores, epochs: slice = slice(SETTLED, None)) -> float:
    """NEES over runs, epochs and nodes; 4 is consistent."""
    return float(np.nanmean(scores.nees[:, epochs]))


def median_nees(scores: Scores, epochs: slice = slice(SETTLED, None)) -> float:
    """NEES of the median run."""
    of_run = [np.nanmean(run) for run in scores.nees[:, epochs] if not np.all(np.isnan(run))]
    return float(np.median(of_run))


def mode_accuracy(scores: Scores, epochs: slice = slice(SETTLED, None)) -> float:
    """Share of node-epochs in which a node knew whether its reading was one."""
    return float(np.nanmean(scores.right[:, epochs]))


class Traffic(NamedTuple):
    """What a node sends in an epoch, on the average."""

    messages: float
    bytes_nominal: float  # 56 bytes a share, 10 an item, and 8 a broadcast
    bytes_sent: float  # the same with all numbers in double precision, as they are sent here


def traffic(config: ConsensusConfig, positions: Floats) -> Traffic:
    """Of nodes (..., N, 3) whose shares all arrive."""
    rounds = config.rounds
    if config.scheme != 'flood':
        return Traffic(rounds, float(rounds * (HEADER + SHARE)), float(rounds * (HEADER + 8 * NUMBERS)))
    known = reached(adjacency(positions, config.radius), max(rounds - 1, 0))  # what came in the last round is kept
    items = float(np.mean(np.sum(known, axis=-1))) if rounds else 0.0
    header = rounds * HEADER
    return Traffic(rounds, header + ITEM * items, header + (ID + 8 * NUMBERS) * items)
