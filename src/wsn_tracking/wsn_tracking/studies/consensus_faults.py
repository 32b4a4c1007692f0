"""What consensus bears: observations that are none, shares that are lost, nodes that die, networks that part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wsn_tracking.models.anchors import Mask
from wsn_tracking.models.graph import adjacency, component_sizes, is_connected
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import Scores, Worlds, mode_accuracy
from wsn_tracking.studies.consensus_schemes import Table, scored
from wsn_tracking.trackers.consensus_config import ArrivalConfig, ConsensusConfig, LinkConfig, ObservationConfig


def faults(field: FieldConfig, runs: int, seed: int) -> Table:
    """What a lost observation reads, against what the filter takes it for; cm, L = 20, and the form as printed."""
    table = []
    for kind in ('zero', 'clutter', 'absent'):
        worlds = runs_of.sample(replace(field, faults=kind), runs, seed)
        for loss in ('uniform', 'zero', 'absent'):
            config = ConsensusConfig(scheme='cm', arrival=ArrivalConfig(loss=loss))
            scores = runs_of.track(config, worlds)
            table.append(scored(f'{kind} faults, {loss} model', scores, {'mode_accuracy': mode_accuracy(scores)}))
    worlds = runs_of.sample(field, runs, seed)
    printed = ConsensusConfig(scheme='cm', observation=ObservationConfig(printed_form=True))
    table.append(scored('zero faults, R without the linearisation error', runs_of.track(printed, worlds), {}))
    return table


def links(worlds: Worlds) -> Table:
    """Shares that are lost, a node that dies, a network that parts and meets again; L = 20."""
    epochs, nodes = worlds.arrived.shape[1:]
    alive = np.ones((epochs, nodes), dtype=np.bool_)
    alive[epochs // 2 :, 0] = False
    held = is_connected(adjacency(worlds.positions[:, 1:], ConsensusConfig().radius))
    table = []
    for scheme in ('cm', 'icf', 'flood', 'hcmci'):
        base = ConsensusConfig(scheme=scheme)
        for loss in (0.0, 0.3, 0.5):
            config = replace(base, link=LinkConfig(loss=loss))
            table.append(scored(f'{scheme}, {loss:.0%} lost', runs_of.track(config, worlds), {}))
        dying = runs_of.track(base, worlds, alive)
        table.append(scored(f'{scheme}, node 1 dies half-way', dying, {}))
        name = f'{scheme}, the same, where that parts nobody ({held.sum()} runs)'
        table.append(scored(name, of_runs(dying, held), {}))
        whole = of_runs(runs_of.track(base, worlds), held)
        table.append(scored(f'{scheme}, the same runs without a death', whole, {}))
        cut = replace(base, link=LinkConfig(cut_at=175.0, cut_from=15, cut_until=30))
        table.append(scored(f'{scheme}, two halves from epoch 15 to 30', runs_of.track(cut, worlds), {}))
    return table + pieces(worlds)


def pieces(worlds: Worlds) -> Table:
    """A radius of 50 m, which connects no field: by how many nodes there are in a component; cm, L = 100."""
    small = ConsensusConfig(scheme='cm', rounds=100, radius=50.0)
    apart, size = runs_of.track(small, worlds), component_sizes(adjacency(worlds.positions, small.radius))
    table = [scored('cm, L = 100, radius 50 m: falls apart', apart, {})]
    sizes = {'nodes alone': (1, 1), 'components of two to four': (2, 4), 'components of five or more': (5, np.inf)}
    for name, (least, most) in sizes.items():
        chosen = (least <= size) & (size <= most)
        table.append(scored(f'the same, {name}', at(apart, chosen), {'share_of_nodes': float(np.mean(chosen))}))
    return table


def of_runs(scores: Scores, runs: Mask) -> Scores:
    """Only some runs (runs,)."""
    return Scores(*(column[runs] for column in scores))


def at(scores: Scores, nodes: Mask) -> Scores:
    """Only some nodes (runs, N) of each run."""
    return Scores(*(np.where(nodes[:, None, :], column, np.nan) for column in scores))
