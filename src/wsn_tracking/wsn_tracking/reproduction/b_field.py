"""Seed 002: consensus of cubature information filters whose observations come and go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.evaluation import consensus_runs as runs_of
from wsn_tracking.evaluation.consensus_runs import SETTLED, Scores, Worlds
from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import PICTURE, Claim, Experiment, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.quantities import curve, mean, path, ratio, root_mean
from wsn_tracking.simulation.b_field import FieldConfig
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


def figure_1(s: Samples) -> Sequence[Figure]:
    """A filter that takes every observation for one, against one that asks."""
    single, multi = s['single model: squares'], s['consensus: squares']
    return [
        root_mean('RMSE, multi-model', multi, 'm', shape=(None, 1.0)),
        root_mean('RMSE, single model', single, 'm'),
        ratio('single / multi-model', single, multi, root=True, shape=(100.0, None)),
    ]


def plot_1(s: Samples) -> Sequence[Plot]:
    """The document's picture."""
    nodes = path('nodes', s[f'{PICTURE}nodes'], 'points')
    tracks = [path(name, s[f'{PICTURE}track, {name}']) for name in ('consensus', 'single model')]
    truth = path('truth', s[f'{PICTURE}truth'], 'truth')
    return [Plot('One run, as node 1 sees it', 'x [m]', 'y [m]', [nodes, truth, *tracks], equal=True)]


def figures_2_3(s: Samples) -> Sequence[Figure]:
    """Nodes 1 and 2 with and without the others, against a centre."""
    found = []
    for i, node in enumerate((1, 2)):
        alone, agreed, more, centre = (
            s[f'{name}: nodes'][:, i] for name in ('no consensus', 'consensus', 'consensus, 100 rounds', 'centralised')
        )
        found += [
            ratio(f'node {node}: alone / consensus', alone, agreed, root=True, shape=(20.0, None)),
            ratio(f'node {node}: consensus, 20 rounds / centralised', agreed, centre, root=True, shape=(None, 1.5)),
            ratio(
                f'node {node}: consensus, 100 rounds / centralised',
                more,
                centre,
                root=True,
                document='almost the same',
                shape=(None, 1.5),
                near=(0.95, 1.05),
            ),
        ]
    return found


def plots_2_3(s: Samples) -> Sequence[Plot]:
    """RMSE by time."""
    names = ('no consensus', 'consensus', 'consensus, 100 rounds', 'centralised')
    time = np.arange(s['consensus: curves'].shape[1], dtype=np.float64).tolist()
    return [
        Plot(
            f'Node {i + 1}',
            't [s]',
            'RMSE [m]',
            [curve(name, time, s[f'{name}: curves'][..., i], root=True) for name in names],
            log_y=True,
        )
        for i in FOLLOWED
    ]


def figures_4_5(s: Samples) -> Sequence[Figure]:
    """How often nodes 1 and 2 know whether their observation is one."""
    found = []
    for i, node in enumerate((1, 2)):
        alone, agreed = s['no consensus: right'][:, i], s['consensus: right'][:, i]
        found += [
            mean(f'node {node}: right with consensus', agreed, '%', 100.0, shape=(99.0, None)),
            mean(f'node {node}: right without', alone, '%', 100.0),
            mean(f'node {node}: gained by consensus', agreed - alone, '%', 100.0, shape=(1.0, None)),
        ]
    clutter, alone = s['clutter, consensus: right'][:, 0], s['clutter, no consensus: right'][:, 0]
    return [
        *found,
        mean('node 1, faults that read anything: right with consensus', clutter, '%', 100.0),
        mean('node 1, faults that read anything: right without', alone, '%', 100.0),
    ]


def plots_4_5(s: Samples) -> Sequence[Plot]:
    """Probabilities of one run."""
    arrived = s[f'{PICTURE}arrived']
    time = np.arange(len(arrived), dtype=np.float64).tolist()
    return [
        Plot(
            f'Node {i + 1}, one run',
            't [s]',
            'probability that it arrived',
            [
                Series('true', time, arrived[:, i].tolist(), style='truth'),
                *(
                    Series(name, time, s[f'{PICTURE}mu, {name}'][:, i].tolist(), style='points')
                    for name in ('consensus', 'no consensus')
                ),
            ],
        )
        for i in FOLLOWED
    ]


CLAIMS = (
    Claim(
        'B1',
        'B',
        'figure 1',
        'A filter that takes every observation for one of the target loses it; one that weighs both models tracks it.',
        FIELD,
        figure_1,
        plot_1,
    ),
    Claim(
        'B2',
        'B',
        'figures 2 and 3',
        'With consensus, nodes 1 and 2 are far more accurate than on their own, and as good as a centralised filter.',
        FIELD,
        figures_2_3,
        plots_2_3,
        'The document does not tell its number of rounds. Averages need about 100 in a network of this size; see '
        'Beyond for schemes that need five.',
    ),
    Claim(
        'B3',
        'B',
        'figures 4 and 5',
        'On their own, nodes 1 and 2 do not know whether their observation arrived; with consensus they do.',
        FIELD,
        figures_4_5,
        plots_4_5,
        'A lost observation of the document reads noise about zero, a range of some 0.1 m: any node tells that from '
        "the target's, alone or not. What made the document's lone nodes fail is not in it. With faults that read "
        'anything, alone is a little worse.',
    ),
)
