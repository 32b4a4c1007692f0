"""What the consensus schemes reach and what they cost (seed 002): a table for the docs, and figures for machines.

    python -m wsn_tracking.evaluation.consensus_study -o docs/results [--runs N]

Writes consensus.json and consensus.md. Times are of the machine that ran it; everything else is repeatable.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import consensus_runs as runs_of
from wsn_tracking.evaluation.consensus_raw import track_raw
from wsn_tracking.evaluation.consensus_runs import Scores, Worlds, mean_nees, median_nees, mode_accuracy, rmse, traffic
from wsn_tracking.files import write_whole
from wsn_tracking.fusion.weights import chebyshev_guard, contraction, metropolis
from wsn_tracking.models.anchors import Mask
from wsn_tracking.models.graph import adjacency, component_sizes, degrees, diameter, is_connected
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.trackers.consensus_config import ArrivalConfig, ConsensusConfig, LinkConfig, ObservationConfig

COMMAND = 'python -m wsn_tracking.evaluation.consensus_study -o docs/results'
SEED = 1
RAW_RUNS = 20  # of floods of readings, which cost fifty times the others
SIZES = (10, 25, 50, 100, 200, 400)  # nodes
Row = dict[str, Any]
Table = list[Row]


def variants() -> Mapping[str, ConsensusConfig]:
    """The schemes and how many rounds they are given; chebyshev is given what it asks for."""
    cm = ConsensusConfig(scheme='cm')
    return {
        'centralised': replace(cm, scheme='flood', rounds=49),
        **{f'cm, L = {L}': replace(cm, rounds=L) for L in (5, 10, 20, 40, 100)},
        **{f'icf, L = {L}': replace(cm, scheme='icf', rounds=L) for L in (5, 10, 20)},
        **{f'flood, {h} hops': replace(cm, scheme='flood', rounds=h) for h in (1, 2, 3, 4, 5, 7, 10)},
        'hcmci, L = 20': replace(cm, scheme='hcmci'),
        'no consensus': replace(cm, rounds=0),
    }


def schemes(worlds: Worlds) -> Table:
    """RMSE and NEES of every scheme, with what a node sends in an epoch."""
    table = [
        _row(name, runs_of.track(config, worlds), traffic(config, worlds.positions)._asdict())
        for name, config in variants().items()
    ]
    table.append(chebyshev_at_its_guard(worlds))
    document = next(row for row in table if row['name'] == 'cm, L = 20')
    for row in table:
        row['rmse_of_cm_20'] = row['rmse_m'] / document['rmse_m']
        row['bytes_of_cm_20'] = row['bytes_nominal'] / document['bytes_nominal']
    return table


def ten_bytes(worlds: Worlds) -> Table:
    """Floods of information against floods of readings in ten bytes an item, over the same runs."""
    table = []
    for hops in (4, 5):
        config = ConsensusConfig(scheme='flood', rounds=hops)
        told = {'bytes_nominal': traffic(config, worlds.positions).bytes_nominal}
        table.append(_row(f'flood of information, {hops} hops', runs_of.track(config, worlds), told))
        table.append(_row(f'flood of readings in ten bytes, {hops} hops', track_raw(config, worlds), told))
    document = runs_of.track(ConsensusConfig(scheme='cm'), worlds)
    for row in table:
        row['rmse_of_cm_20'] = row['rmse_m'] / rmse(document)
    return table


def guards(worlds: Worlds) -> np.ndarray:
    """Rounds from which on acceleration pays in each run, (runs,)."""
    graph = adjacency(worlds.positions, ConsensusConfig().radius)
    return np.array([chebyshev_guard(float(rho)) for rho in contraction(metropolis(graph, degrees(graph)))])


def chebyshev_at_its_guard(worlds: Worlds) -> Row:
    """Every run with the fewest rounds that pay in its own field."""
    guard, parts, sent = guards(worlds), [], []
    for rounds in np.unique(guard):
        config = ConsensusConfig(scheme='chebyshev', rounds=int(rounds))
        chosen = runs_of.some(worlds, guard == rounds)
        parts.append(runs_of.track(config, chosen))
        sent += [traffic(config, chosen.positions)] * len(chosen.positions)
    scores = Scores(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    name = f'chebyshev, L = {guard.min()} to {guard.max()}'
    return _row(name, scores, {key: float(np.mean([getattr(t, key) for t in sent])) for key in sent[0]._fields})


def faults(field: FieldConfig, runs: int) -> Table:
    """What a lost observation reads, against what the filter takes it for; cm, L = 20, and the form as printed."""
    table = []
    for kind in ('zero', 'clutter', 'absent'):
        worlds = runs_of.sample(replace(field, faults=kind), runs, SEED)
        for loss in ('uniform', 'zero', 'absent'):
            config = ConsensusConfig(scheme='cm', arrival=ArrivalConfig(loss=loss))
            scores = runs_of.track(config, worlds)
            table.append(_row(f'{kind} faults, {loss} model', scores, {'mode_accuracy': mode_accuracy(scores)}))
    worlds = runs_of.sample(field, runs, SEED)
    printed = ConsensusConfig(scheme='cm', observation=ObservationConfig(printed_form=True))
    table.append(_row('zero faults, R without the linearisation error', runs_of.track(printed, worlds), {}))
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
            table.append(_row(f'{scheme}, {loss:.0%} lost', runs_of.track(config, worlds), {}))
        dying = runs_of.track(base, worlds, alive)
        table.append(_row(f'{scheme}, node 1 dies half-way', dying, {}))
        name = f'{scheme}, the same, where that parts nobody ({held.sum()} runs)'
        table.append(_row(name, _some(dying, held), {}))
        whole = _some(runs_of.track(base, worlds), held)
        table.append(_row(f'{scheme}, the same runs without a death', whole, {}))
        cut = replace(base, link=LinkConfig(cut_at=175.0, cut_from=15, cut_until=30))
        table.append(_row(f'{scheme}, two halves from epoch 15 to 30', runs_of.track(cut, worlds), {}))
    return table + pieces(worlds)


def pieces(worlds: Worlds) -> Table:
    """A radius of 50 m, which connects no field: by how many nodes there are in a component; cm, L = 100."""
    small = ConsensusConfig(scheme='cm', rounds=100, radius=50.0)
    apart, size = runs_of.track(small, worlds), component_sizes(adjacency(worlds.positions, small.radius))
    table = [_row('cm, L = 100, radius 50 m: falls apart', apart, {})]
    sizes = {'nodes alone': (1, 1), 'components of two to four': (2, 4), 'components of five or more': (5, np.inf)}
    for name, (least, most) in sizes.items():
        chosen = (least <= size) & (size <= most)
        table.append(_row(f'the same, {name}', at(apart, chosen), {'share_of_nodes': float(np.mean(chosen))}))
    return table


def _some(scores: Scores, runs: Mask) -> Scores:
    return Scores(*(column[runs] for column in scores))


def at(scores: Scores, nodes: Mask) -> Scores:
    """Only some nodes (runs, N) of each run."""
    return Scores(*(np.where(nodes[:, None, :], column, np.nan) for column in scores))


def scaling(field: FieldConfig, node_epochs: int) -> Table:
    """From 10 to 400 nodes at the density of the document: what a node-epoch costs and what a node sends."""
    table = []
    for nodes in SIZES:
        side = float(np.sqrt(nodes / 50.0))
        grown = replace(field, nodes=nodes, width=350.0 * side, depth=400.0 * side, epochs=20)
        runs = max(node_epochs // (nodes * grown.epochs), 1)
        worlds = runs_of.sample(grown, runs, SEED)
        graph = adjacency(worlds.positions, ConsensusConfig().radius)
        row: Row = {'name': f'{nodes} nodes', 'runs': runs, 'neighbours': float(np.mean(degrees(graph)))}
        row['diameter'] = diameter(graph)
        for name, config in {
            'icf_20': ConsensusConfig(),
            'flood_5': ConsensusConfig(scheme='flood', rounds=5),
        }.items():
            began = time.process_time()
            scores = runs_of.track(config, worlds)
            row[f'us_a_node_epoch_{name}'] = 1e6 * (time.process_time() - began) / scores.nees.size
            row[f'rmse_m_{name}'] = rmse(scores)
            row[f'bytes_nominal_{name}'] = traffic(config, worlds.positions).bytes_nominal
        table.append(row)
    return table


def _row(name: str, scores: Scores, more: Mapping[str, Any]) -> Row:
    typical = {'nees_median_run': median_nees(scores)}  # one run that loses its track outweighs all others in the mean
    return {'name': name, 'rmse_m': rmse(scores), 'nees': mean_nees(scores), **typical, **more}


def study(runs: int) -> Mapping[str, Table]:
    """All tables."""
    field = FieldConfig()
    worlds = runs_of.sample(field, runs, SEED)
    tables: Mapping[str, Callable[[], Table]] = {
        'schemes': lambda: schemes(worlds),
        'ten_bytes': lambda: ten_bytes(runs_of.some(worlds, slice(0, RAW_RUNS))),
        'faults': lambda: faults(field, runs),
        'links': lambda: links(worlds),
        'scaling': lambda: scaling(field, 100 * runs * 10),
    }
    results = {}
    for name, make in tables.items():
        print(f'consensus: {name}', file=sys.stderr, flush=True)
        results[name] = make()
    return results


def markdown(tables: Mapping[str, Table], runs: int) -> str:
    """The tables as text."""
    lines = [f'<!-- made by {COMMAND}; {runs} runs, seed {SEED} -->']
    for name, table in tables.items():
        columns = list(dict.fromkeys(key for row in table for key in row))
        lines += ['', f'### {name}', '', f'| {" | ".join(columns)} |', f'|{"---|" * len(columns)}']
        lines += [f'| {" | ".join(_cell(row.get(column, "")) for column in columns)} |' for row in table]
    return '\n'.join(lines) + '\n'


def _cell(value: Any) -> str:
    return f'{value:.4g}' if isinstance(value, float) else str(value)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    parser = argparse.ArgumentParser(prog='wsn_tracking.evaluation.consensus_study', description=__doc__.split('\n')[0])
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder of the results')
    parser.add_argument('--runs', type=int, default=100, help='runs of each row (default: 100)')
    options = parser.parse_args(arguments)
    try:
        tables = study(options.runs)
        content = {'command': COMMAND, 'runs': options.runs, 'seed': SEED, 'tables': tables}
        text = json.dumps(content, indent=2, allow_nan=False) + '\n'
        write_whole(options.output / 'consensus.json', text.encode())
        write_whole(options.output / 'consensus.md', markdown(tables, options.runs).encode())
    except TrackingError as error:
        print(f'consensus_study: {error}', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())
