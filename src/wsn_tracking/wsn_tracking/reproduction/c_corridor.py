"""Seed 003, section 5: two channels against one in a corridor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.reproduction.c_filters import ONE, PAPER, compared, maps
from wsn_tracking.reproduction.claims import Claim, Experiment, Figure, Samples
from wsn_tracking.reproduction.quantities import mean, median
from wsn_tracking.simulation.c_body import CorridorConfig
from wsn_tracking.studies.human import baseline, direction
from wsn_tracking.studies.human_runs import SETTLED, distances, sample, track

AWAY = 5.0  # [m] a walk with a larger mean error has lost its person


def corridor(seed: int, runs: int) -> Samples:
    """The direction filter against one curve, with 50 particles as the document has it, and with 200."""
    walks = sample(CorridorConfig(), runs, seed)
    configs = {}
    for particles in (50, 200):
        configs[f'{PAPER}, {particles}'] = direction(0.5, particles=particles)
        configs[f'{ONE}, {particles}'] = baseline(0.5, widened=False, particles=particles)
    samples = dict(compared(configs, walks, seed))
    for name, config in configs.items():  # the document's figures here are of the mean, not of the root
        d = distances(track(config, walks, seed), walks)[:, walks.times >= SETTLED]
        samples[f'{name}: mean'] = d.mean(axis=-1)
    return samples


CORRIDOR = Experiment('c corridor', corridor, runs=10, units=10, quick=4)


def experiment(s: Samples) -> Sequence[Figure]:
    """Error of the median walk in metres, and by how many percent."""
    two, one = s[f'{PAPER}, 50: mean'], s[f'{ONE}, 50: mean']
    lost = 100.0 * (np.stack([s[f'{n}, 50: mean'] for n in (PAPER, ONE)]) > AWAY)
    return [
        median(f'{PAPER} better by', 100.0 * (1.0 - two / one), '%', document=34.7, shape=(15.0, None)),
        median(f'error, {PAPER}', two, 'm', document=0.64, shape=(None, 0.98)),
        median(f'error, {ONE}', one, 'm', document=0.98),
        *(mean(f'walks that are lost, {n}', lost[i], '%') for i, n in enumerate((PAPER, ONE))),
        median(
            f'error, {PAPER} / {ONE}, 200 particles',
            s[f'{PAPER}, 200: mean'] / s[f'{ONE}, 200: mean'],
            shape=(None, 0.6),
        ),
    ]


CLAIMS = (
    Claim(
        'C5',
        'C',
        'section 5',
        'In a corridor, with 50 particles, two curves reach 0.64 m and one reaches 0.98 m: 34.7 % better.',
        CORRIDOR,
        experiment,
        lambda s: [maps('One run', s, (f'{PAPER}, 50', f'{ONE}, 50'))],
        'The recording is not published: this is a simulated corridor of its size, nodes, speed and period. The '
        'document has one walk; ours are of the median one, since with 50 particles some walks are lost.',
        in_kind=True,
    ),
)
