"""Beyond seed 003: what the filters bear: a body that turns, readings that are anything, a target that jumps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.c_filters import PAPER, compared
from wsn_tracking.reproduction.c_profiles import OURS
from wsn_tracking.reproduction.claims import BEYOND, Claim, Experiment, Figure, Samples
from wsn_tracking.reproduction.quantities import mean, median, ratio
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.studies.human import IMPROVED, PAPER_MAX
from wsn_tracking.studies.human_parts import recovery
from wsn_tracking.studies.human_runs import distances, sample, track
from wsn_tracking.trackers.human_config import MotionConfig, ResamplingConfig, SignalConfig, StartConfig

JUMP = 60.0  # [s] when a target jumps


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
