"""Seed 003, figures 5 and 6: two channels against one with denser nodes, and with more noise."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.c_filters import ONE, PAPER, REACH, compared
from wsn_tracking.reproduction.claims import Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import curve, ratio
from wsn_tracking.simulation.c_body import BodyConfig, SpacingConfig
from wsn_tracking.studies.human import NOISES, PAPER_MAX, SPACINGS, baseline
from wsn_tracking.studies.human_runs import sample
from wsn_tracking.trackers.human_config import HumanConfig, MotionConfig

# ---- figure 5: denser nodes


def spacing(seed: int, runs: int) -> Samples:
    """Both filters by the distance between nodes; every spacing has the same walks."""
    samples: dict[str, Floats] = {}
    paper = HumanConfig(profile='paper_max', particles=400, motion=MotionConfig(v_max=3.0))
    for columns, metres in SPACINGS.items():
        walks = sample(SpacingConfig(columns=columns, rows=columns), runs, seed)
        found = compared({PAPER: paper, ONE: baseline(3.0, particles=400)}, walks, seed)
        samples |= {f'{name} {metres:g}': found[name] for name in (PAPER, ONE)}
    return samples


SPACING = Experiment('c spacing', spacing, runs=6, units=12, quick=3)


def figure_5(s: Samples) -> Sequence[Figure]:
    """Each refinement, and the other filter."""
    metres = list(SPACINGS.values())
    pairs = pairwise(metres)
    return [
        *(
            ratio(f'{PAPER}: {b:g} m / {a:g} m', s[f'{PAPER} {b:g}'], s[f'{PAPER} {a:g}'], True, shape=(None, 1.0))
            for a, b in pairs
        ),
        *(
            ratio(f'{PAPER} / {ONE}, {m:g} m', s[f'{PAPER} {m:g}'], s[f'{ONE} {m:g}'], True, shape=(None, 1.0))
            for m in metres
        ),
    ]


def plot_5(s: Samples) -> Sequence[Plot]:
    """RMSE by spacing, both over 50 m."""
    metres = list(SPACINGS.values())
    x = [m / REACH for m in metres]
    lines = [
        curve(name, x, np.stack([s[f'{name} {m:g}'] for m in metres], axis=1), root=True, scale=1.0 / REACH)
        for name in (PAPER, ONE)
    ]
    return [Plot('Distance between nodes', 'spacing / 50 m', 'RMSE / 50 m', lines)]


# ---- figure 6: more noise


def noise(seed: int, runs: int) -> Samples:
    """Both filters by the deviation of a reading."""
    samples: dict[str, Floats] = {}
    for sigma in NOISES:
        walks = sample(BodyConfig(sigma=sigma), runs, seed)
        found = compared({PAPER: PAPER_MAX, ONE: baseline(3.0)}, walks, seed)
        samples |= {f'{name} {sigma:g}': found[name] for name in (PAPER, ONE)}
    return samples


NOISE = Experiment('c noise', noise, runs=6, units=12, quick=3)


def figure_6(s: Samples) -> Sequence[Figure]:
    """Each step of noise; the other filter hardly cares."""
    pairs = pairwise(NOISES)
    return [
        *(
            ratio(f'{PAPER}: {b:g} dB / {a:g} dB', s[f'{PAPER} {b:g}'], s[f'{PAPER} {a:g}'], True, shape=(1.0, None))
            for a, b in pairs
        ),
        *(
            ratio(f'{PAPER} / {ONE}, {n:g} dB', s[f'{PAPER} {n:g}'], s[f'{ONE} {n:g}'], True, shape=(None, 1.0))
            for n in NOISES
        ),
        *(
            ratio(f'{ONE}: {n:g} dB / 0.5 dB', s[f'{ONE} {n:g}'], s[f'{ONE} 0.5'], True, shape=(0.7, 1.3))
            for n in NOISES[1:]
        ),
    ]


def plot_6(s: Samples) -> Sequence[Plot]:
    """RMSE by noise."""
    lines = [
        curve(name, NOISES, np.stack([s[f'{name} {n:g}'] for n in NOISES], axis=1), root=True, scale=1.0 / REACH)
        for name in (PAPER, ONE)
    ]
    return [Plot('Noise of a reading', 's [dB]', 'RMSE / 50 m', lines)]


CLAIMS = (
    Claim(
        'C3',
        'C',
        'figure 5',
        'The closer the nodes, the better both filters; two curves are better at every spacing.',
        SPACING,
        figure_5,
        plot_5,
    ),
    Claim(
        'C4',
        'C',
        'figure 6',
        'The error of two curves grows with the noise, that of one curve hardly changes, and stays above.',
        NOISE,
        figure_6,
        plot_6,
    ),
)
