"""What every consensus scheme of seed 002 reaches, and what a node sends for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wsn_tracking.fusion.weights import chebyshev_guard, contraction, metropolis
from wsn_tracking.models.graph import adjacency, degrees
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_raw import track_raw
from wsn_tracking.studies.consensus_runs import Scores, Worlds, mean_nees, median_nees, rmse, traffic
from wsn_tracking.trackers.consensus_config import ConsensusConfig, ObservationConfig

Row = dict[str, Any]
Table = list[Row]


def scored(name: str, scores: Scores, more: Mapping[str, Any]) -> Row:
    """A row of a table: accuracy, honesty, and what else is told."""
    typical = {'nees_median_run': median_nees(scores)}  # one run that loses its track outweighs all others in the mean
    return {'name': name, 'rmse_m': rmse(scores), 'nees': mean_nees(scores), **typical, **more}


def variants() -> Mapping[str, ConsensusConfig]:
    """The schemes and how many rounds they are given; chebyshev is given what it asks for. w: linearisation_epochs."""
    cm = ConsensusConfig(scheme='cm')
    told = {
        'centralised': replace(cm, scheme='flood', rounds=49),
        **{f'cm, L = {L}': replace(cm, rounds=L) for L in (5, 10, 20, 40, 100)},
        **{f'icf, L = {L}': replace(cm, scheme='icf', rounds=L) for L in (5, 10, 20)},
        **{f'flood, {h} hops': replace(cm, scheme='flood', rounds=h) for h in (1, 2, 3, 4, 5, 7, 10)},
        'hcmci, L = 20': replace(cm, scheme='hcmci'),
        'no consensus': replace(cm, rounds=0),
    }
    kalman = ObservationConfig(linearisation_epochs=1.0)
    for name in ('cm, L = 20', 'flood, 1 hops', 'no consensus'):
        told[f'{name}, w = 1'] = replace(told[name], observation=kalman)
    return told


def schemes(worlds: Worlds) -> Table:
    """RMSE and NEES of every scheme, with what a node sends in an epoch."""
    table = [
        scored(name, runs_of.track(config, worlds), traffic(config, worlds.positions)._asdict())
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
        table.append(scored(f'flood of information, {hops} hops', runs_of.track(config, worlds), told))
        table.append(scored(f'flood of readings in ten bytes, {hops} hops', track_raw(config, worlds), told))
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
    return scored(name, scores, {key: float(np.mean([getattr(t, key) for t in sent])) for key in sent[0]._fields})
