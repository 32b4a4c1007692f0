"""Beyond seed 003: what a better model of walking and of the body is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.reproduction.c_filters import ONE, PAPER, compared, maps
from wsn_tracking.reproduction.claims import BEYOND, Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import bars, mean, median, ratio, root_mean
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.studies.human import IMPROVED, PAPER_MAX, baseline
from wsn_tracking.studies.human_runs import sample

OURS, LAGGED, MANY = 'improved', 'improved, 3 s later', 'improved, 2000 particles'
CONFIGS = {
    ONE: baseline(3.0),
    PAPER: PAPER_MAX,
    OURS: IMPROVED,
    LAGGED: replace(IMPROVED, lag=3.0),
    MANY: replace(IMPROVED, particles=2000),
}


def profiles(seed: int, runs: int) -> Samples:
    """All filters over the same walks."""
    walks = sample(BodyConfig(), runs, seed)
    heard = np.sum(~np.isnan(walks.z), axis=-1).mean(axis=-1)
    return {**compared(CONFIGS, walks, seed), 'heard': np.asarray(heard)}


PROFILES = Experiment('c profiles', profiles, runs=8, units=12, quick=3)


def walking(s: Samples) -> Sequence[Figure]:
    """RMSE against the document's filters and against many particles; honesty."""
    return [
        ratio(f'RMSE, {OURS} / {PAPER}', s[OURS], s[PAPER], True, shape=(None, 0.97)),
        ratio(f'RMSE, {OURS} / {ONE}', s[OURS], s[ONE], True, shape=(None, 0.35)),
        ratio(f'RMSE, {LAGGED} / {OURS}', s[LAGGED], s[OURS], True, shape=(None, 0.9)),
        ratio(f'RMSE, {OURS}, 500 particles / 2000', s[OURS], s[MANY], True, shape=(None, 1.15)),
        root_mean(f'RMSE, {OURS}', s[OURS], 'm'),
        median(f'NEES (of 2) of the median walk, {PAPER}', s[f'{PAPER}: nees']),
        median(f'NEES (of 2) of the median walk, {OURS}', s[f'{OURS}: nees']),
        mean('readings an epoch, which all filters share', s['heard']),
    ]


def walking_plot(s: Samples) -> Sequence[Plot]:
    """RMSE of all, and a track."""
    shown = [(name.replace('improved, ', ''), root_mean(name, s[name])) for name in CONFIGS]
    return [Plot('Accuracy', 'filter', 'RMSE [m]', [bars('ours', shown)]), maps('One walk', s, (PAPER, OURS))]


CLAIMS = (
    Claim(
        'C21',
        'C',
        'walks and pauses',
        "A filter that knows that people walk, pause and turn is more accurate than the document's, a third of one "
        "curve's error, and close to what many more particles give; three seconds later it knows better still.",
        PROFILES,
        walking,
        walking_plot,
        kind=BEYOND,
    ),
)
