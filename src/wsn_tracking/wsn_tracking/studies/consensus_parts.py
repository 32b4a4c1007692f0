"""Networks that fall apart: components of a few nodes, and what a death cuts off."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.graph import adjacency, component_sizes
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import SETTLED, Scores, Worlds, mean_nees, median_nees, rmse
from wsn_tracking.studies.consensus_schemes import Row, Table, scored
from wsn_tracking.trackers.consensus_config import ArrivalConfig, ConsensusConfig, ObservationConfig

RADIUS = 50.0  # [m] connects no field
BATCH = 15  # runs of a test
VARIANTS = (*(('uniform', float(w)) for w in (1, 4, 8, 16)), ('zero', 1.0), ('zero', 8.0))
SIZES = {'alone': (1, 1), 'two_to_four': (2, 4), 'five_or_more': (5, np.inf)}
DYING = 10  # nodes of each field, one at a time


def parts(field: FieldConfig, runs: int, seed: int) -> Table:
    """Components at RADIUS: by loss model and by w, for how many epochs a linearisation error counts as one."""
    worlds = runs_of.sample(field, runs, seed)
    size = component_sizes(adjacency(worlds.positions, RADIUS))
    table = []
    for loss, w in VARIANTS:
        config = ConsensusConfig(
            scheme='cm',
            rounds=100,
            radius=RADIUS,
            arrival=ArrivalConfig(loss=loss),
            observation=ObservationConfig(linearisation_epochs=w),
        )
        scores = runs_of.track(config, worlds)
        row = scored(f'{loss} model, w = {w:g}', scores, _of_batches(scores))
        for name, (least, most) in SIZES.items():
            chosen = (least <= size) & (size <= most)
            if np.any(chosen):
                part = at(scores, chosen)
                row |= {f'share_{name}': float(np.mean(chosen)), f'rmse_m_{name}': rmse(part)}
                row |= {f'nees_{name}': mean_nees(part), f'nees_median_run_{name}': median_nees(part)}
        table.append(row)
    return table


def _of_batches(scores: Scores) -> Row:
    """What a test of so many runs would see."""
    of_run = np.mean(scores.nees[:, SETTLED:], axis=(1, 2))
    of_batch = np.array([np.mean(of_run[i : i + BATCH]) for i in range(0, max(len(of_run) - BATCH, 0) + 1, BATCH)])
    return {'nees_median_batch': float(np.median(of_batch)), 'batches_up_to_5': float(np.mean(of_batch <= 5.0))}


def at(scores: Scores, nodes: Mask) -> Scores:
    """Only some nodes (runs, N) of each run."""
    return Scores(*(np.where(nodes[:, None, :], column, np.nan) for column in scores))


def deaths(worlds: Worlds) -> Table:
    """A node dies half-way, each of the first DYING in turn, whether that parts the field or not; L = 20.

    Ratios are of the survivors' error to what it is without the death. Whoever is left with at most half of the nodes
    is cut off.
    """
    return [_deaths(ConsensusConfig(scheme=scheme), worlds) for scheme in ('cm', 'icf', 'flood', 'hcmci')]


def _deaths(config: ConsensusConfig, worlds: Worlds) -> Row:
    columns = zip(*_each_death(config, worlds), strict=True)
    after, before, size = (np.concatenate(column) for column in columns)
    together = size > worlds.arrived.shape[-1] / 2
    of_death = np.sqrt(after.mean(axis=-1) / before.mean(axis=-1))
    row: Row = {'name': config.scheme, 'deaths': len(after), 'parting': int(np.sum(~np.all(together, axis=-1)))}
    row |= {
        'ratio_together': _ratio(after, before, together),
        'ratio_all': _ratio(after, before, size > 0),
        'median_ratio': float(np.median(of_death)),
        'share_up_to_1.1': float(np.mean(of_death <= 1.1)),
        'share_cut_off': float(np.mean(~together)),
    }
    for name, (least, most) in SIZES.items():
        chosen = ~together & (least <= size) & (size <= most)
        if np.any(chosen):
            row |= {f'cut_off_{name}': int(np.sum(chosen)), f'rmse_m_{name}': float(np.sqrt(np.mean(after[chosen])))}
    return row


def _each_death(config: ConsensusConfig, worlds: Worlds) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Mean squared errors (runs, N - 1) of the survivors, the same without the death, and the sizes of their parts."""
    epochs, nodes = worlds.arrived.shape[1:]
    half = epochs // 2
    whole = runs_of.track(config, worlds).squares[:, half:]
    for dead in range(min(DYING, nodes)):
        others = np.arange(nodes) != dead
        alive = np.ones((epochs, nodes), dtype=np.bool_)
        alive[half:, dead] = False
        squares = runs_of.track(config, worlds, alive).squares[:, half:]
        size = component_sizes(adjacency(worlds.positions[:, others], config.radius))
        yield squares[..., others].mean(axis=1), whole[..., others].mean(axis=1), size


def _ratio(after: Floats, before: Floats, chosen: Mask) -> float:
    return float(np.sqrt(np.mean(after[chosen]) / np.mean(before[chosen])))
