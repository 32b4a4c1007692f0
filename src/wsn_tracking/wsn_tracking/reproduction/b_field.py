"""Seed 002: runs of consensus filters whose observations come and go, on the document's field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import PICTURE, Experiment, Samples
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_runs import SETTLED, Scores, Worlds
from wsn_tracking.trackers.consensus_config import ArrivalConfig, ConsensusConfig

CM = ConsensusConfig(scheme='cm', arrival=ArrivalConfig(loss='zero'))  # as the document has it
VARIANTS = {
    'single model': replace(CM, arrival=ArrivalConfig(loss='absent')),
    'consensus': CM,
    'consensus, 100 rounds': replace(CM, rounds=100),
    'no consensus': replace(CM, rounds=0),
    'centralised': replace(CM, scheme='flood', rounds=49),
}
FOLLOWED = (0, 1)  # nodes 1 and 2
SCORED = slice(SETTLED, None)


def settled(values: Floats) -> Floats:
    """Mean over epochs from the fifth on and nodes, (runs, K, N) -> (runs,)."""
    return np.asarray(np.nanmean(values[:, SCORED], axis=(1, 2)))


def kept(scores: Scores, name: str) -> dict[str, Floats]:
    """What the claims need of a variant."""
    some = scores.squares[..., FOLLOWED]
    right = scores.right[:, SCORED][..., FOLLOWED].mean(axis=1)
    return {
        f'{name}: squares': settled(scores.squares),
        f'{name}: nees': settled(scores.nees),
        f'{name}: nodes': some[:, SCORED].mean(axis=1),
        f'{name}: curves': some,
        f'{name}: right': right,
    }


def field(seed: int, runs: int) -> Samples:
    """The document's field: squared errors and NEES of its variants, the followed nodes' by epoch."""
    worlds = runs_of.sample(FieldConfig(), runs, seed)
    samples: dict[str, Floats] = {}
    for name, config in VARIANTS.items():
        samples |= kept(runs_of.track(config, worlds), name)
    clutter = runs_of.sample(replace(FieldConfig(), faults='clutter'), runs, seed)
    for name in ('consensus', 'no consensus'):
        config = replace(VARIANTS[name], arrival=ArrivalConfig(loss='uniform'))
        samples |= kept(runs_of.track(config, clutter), f'clutter, {name}')
    return {**samples, **pictures(runs_of.some(worlds, slice(0, 1)))}


def pictures(worlds: Worlds) -> dict[str, Floats]:
    """One run: the field, the tracks of node 1, and how sure nodes 1 and 2 are that theirs arrived."""
    shown = {
        f'{PICTURE}nodes': worlds.positions[0, :, :2],
        f'{PICTURE}truth': worlds.states[0, :, :2],
        f'{PICTURE}arrived': worlds.arrived[0][:, FOLLOWED].astype(np.float64),
    }
    for name in ('single model', 'consensus', 'no consensus'):
        after = list(runs_of.steps(VARIANTS[name], worlds))
        shown[f'{PICTURE}track, {name}'] = np.stack([nodes.belief.m[0, 0, :2] for nodes in after])
        shown[f'{PICTURE}mu, {name}'] = np.stack([nodes.mu[0, FOLLOWED] for nodes in after])
    return shown


FIELD = Experiment('b field', field, runs=10, units=20, quick=7)
