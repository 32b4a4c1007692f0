"""What consensus bears: observations that are none, shares that are lost, networks that part and meet again."""

from __future__ import annotations

from dataclasses import replace

from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import Worlds, mode_accuracy
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
    """Shares that are lost, and a network that parts and meets again; L = 20."""
    table = []
    for scheme in ('cm', 'icf', 'flood', 'hcmci'):
        base = ConsensusConfig(scheme=scheme)
        for loss in (0.0, 0.3, 0.5):
            config = replace(base, link=LinkConfig(loss=loss))
            table.append(scored(f'{scheme}, {loss:.0%} lost', runs_of.track(config, worlds), {}))
        cut = replace(base, link=LinkConfig(cut_at=175.0, cut_from=15, cut_until=30))
        table.append(scored(f'{scheme}, two halves from epoch 15 to 30', runs_of.track(cut, worlds), {}))
    return table
