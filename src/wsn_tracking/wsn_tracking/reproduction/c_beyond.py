"""Beyond seed 003: what a better model of walking and of the body is worth, and what it bears."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wsn_tracking.evaluation.human_runs import distances, sample, track
from wsn_tracking.evaluation.study_human import IMPROVED, PAPER_MAX, baseline
from wsn_tracking.evaluation.study_human_parts import recovery
from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.c_filters import ONE, PAPER, compared, maps
from wsn_tracking.reproduction.claims import BEYOND, Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import bars, mean, median, ratio, root_mean
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.trackers.human_config import MotionConfig, ResamplingConfig, SignalConfig, StartConfig

OURS, LAGGED, MANY = 'improved', 'improved, 3 s later', 'improved, 2000 particles'
CONFIGS = {
    ONE: baseline(3.0),
    PAPER: PAPER_MAX,
    OURS: IMPROVED,
    LAGGED: replace(IMPROVED, lag=3.0),
    MANY: replace(IMPROVED, particles=2000),
}
JUMP = 60.0  # [s] when a target jumps


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


# ---- what goes wrong


def trouble(seed: int, runs: int) -> Samples:
    """Resampling as printed, a turned body, outliers."""
    plain, turned = sample(BodyConfig(), runs, seed), sample(BodyConfig(yaw=math.radians(30.0)), runs, seed)
    wild = sample(BodyConfig(outliers=0.1), runs, seed)
    inverted = replace(PAPER_MAX, resampling=ResamplingConfig(inverted=True))
    trusting = replace(IMPROVED, signal=SignalConfig(outlier=0.0))
    stiff = replace(IMPROVED, motion=MotionConfig(yaw=0.0))
    groups = {
        'plain': (plain, {PAPER: PAPER_MAX, 'resampled as printed': inverted}),
        'turned': (turned, {PAPER: PAPER_MAX, OURS: IMPROVED, 'without yaw': stiff}),
        'wild': (wild, {PAPER: PAPER_MAX, OURS: IMPROVED, 'without mass': trusting}),
    }
    samples: dict[str, Floats] = {}
    for group, (walks, configs) in groups.items():
        samples |= {f'{group}: {name}': v for name, v in compared(configs, walks, seed).items() if name in configs}
    return samples


TROUBLE = Experiment('c trouble', trouble, runs=8, units=10, quick=2)


def jump(seed: int, runs: int) -> Samples:
    """How soon a target that has jumped is found again (runs,) [s]."""
    samples = {}
    jumping = sample(BodyConfig(teleport_at=JUMP, duration=JUMP + 60.0), runs, seed)
    never = replace(IMPROVED, start=StartConfig(reset_epochs=0))
    for name, config in {'reset': IMPROVED, 'no reset': never}.items():
        samples[f'jump: {name}'] = recovery(distances(track(config, jumping, seed), jumping), jumping.times, JUMP)
    return samples


JUMPS = Experiment('c jumps', jump, runs=20, units=8, quick=2)


def repaired(s: Samples) -> Sequence[Figure]:
    """What is printed the wrong way round."""
    return [
        ratio(
            'RMSE, resampled as printed / as meant',
            s['plain: resampled as printed'],
            s[f'plain: {PAPER}'],
            True,
            shape=(2.0, None),
        )
    ]


def borne(s: Samples) -> Sequence[Figure]:
    """A body that turns, readings that are anything."""
    return [
        ratio(
            f'body turned 30 deg: {OURS} / {PAPER}',
            s[f'turned: {OURS}'],
            s[f'turned: {PAPER}'],
            True,
            shape=(None, 1.0),
        ),
        ratio('body turned 30 deg: with / without its yaw', s[f'turned: {OURS}'], s['turned: without yaw'], True),
        ratio(
            '10 % outliers: with / without mass', s[f'wild: {OURS}'], s['wild: without mass'], True, shape=(None, 0.75)
        ),
        ratio(f'10 % outliers: {OURS} / {PAPER}', s[f'wild: {OURS}'], s[f'wild: {PAPER}'], True),
    ]


def again(s: Samples) -> Sequence[Figure]:
    """After a jump."""
    return [
        median('jump: found again after (median walk)', s['jump: reset'], 's', shape=(None, 8.0)),
        median('jump: without a reset', s['jump: no reset'], 's'),
        mean('jump: later without a reset by', s['jump: no reset'] - s['jump: reset'], 's', shape=(5.0, None)),
    ]


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
    Claim(
        'C22',
        'C',
        'section 3.4, step 4',
        'Resampling when the effective number of particles is large, as printed, ruins the filter; it is meant to be '
        'small.',
        TROUBLE,
        repaired,
        kind=BEYOND,
    ),
    Claim(
        'C23',
        'C',
        'what goes wrong',
        'The improved filter bears a body that does not face where it walks, and readings that are anything.',
        TROUBLE,
        borne,
        kind=BEYOND,
    ),
    Claim(
        'C24',
        'C',
        'what goes wrong',
        'A target that jumps is found again, since particles are drawn anew when readings surprise them all.',
        JUMPS,
        again,
        kind=BEYOND,
    ),
)
