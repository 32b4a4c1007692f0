"""Seed 002, figures 1 to 5: single and multi model, with the others and alone, and what nodes know of their own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.reproduction.b_field import FIELD, FOLLOWED
from wsn_tracking.reproduction.claims import PICTURE, Claim, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.quantities import curve, mean, path, ratio, root_mean


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
