"""Seed 000, section 3.1: filters of fixed and of random process noise on a target that always turns; figure 2."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import Claim, Experiment, Figure, Plot, Samples, Series
from wsn_tracking.reproduction.quantities import curve, mean, ratio
from wsn_tracking.studies.random_q_noise import FIXED, INTERVALS, RULES, Circle

EI_OF_7 = 9.2233  # [cm]


def key(interval: tuple[float, float]) -> str:
    """[2,6] and so on."""
    return '[{:g},{:g}]'.format(*interval)


def circle(seed: int, runs: int) -> Samples:
    """EI (runs,) [m] on a_circle: one filter with a fixed q, three with a random one, and their fusions."""
    world = Circle(runs, seed)
    samples: dict[str, Floats] = {f'q {q:g}': world.fixed(q) for q in FIXED}
    for interval in INTERVALS:
        tracks = world.drawn(interval)
        samples[f'local {key(interval)}'] = world.local(tracks)
        for rule in RULES:
            samples[f'{rule} {key(interval)}'] = world.fused(tracks, rule)
    return samples


CIRCLE = Experiment('a circle', circle, runs=100, units=20, quick=6)


def figure_2(s: Samples) -> Sequence[Figure]:
    """Too little noise costs more than too much, and the best is near 7."""
    seven = s['q 7']
    little, much = s['q 2'] - seven, s['q 12'] - seven
    return [
        ratio('EI(q = 2) / EI(7)', s['q 2'], seven, shape=(1.2, None)),
        ratio('EI(q = 5) / EI(7)', s['q 5'], seven, shape=(1.01, None)),
        ratio('EI(q = 9) / EI(7)', s['q 9'], seven, shape=(1.005, None)),
        ratio('EI(q = 12) / EI(7)', s['q 12'], seven, shape=(1.04, None)),
        ratio('loss at q = 2 / loss at q = 12', little, much, shape=(1.5, None)),
    ]


def plot_2(s: Samples) -> Sequence[Plot]:
    """EI by q."""
    values = np.stack([s[f'q {q:g}'] for q in FIXED], axis=1)
    told = Series('document, q = 7', [7.0], [EI_OF_7], style='points')
    return [Plot('Error by process noise', 'q', 'EI [cm]', [curve('ours', FIXED, values, scale=100.0), told])]


def level(s: Samples) -> Sequence[Figure]:
    """The one number of figure 2."""
    return [mean('EI(q = 7)', s['q 7'], 'cm', 100.0, document=EI_OF_7, shape=(6.9, 11.5), near=(8.76, 9.68))]


CLAIMS = (
    Claim(
        'A1',
        'A',
        'figure 2',
        'There is a best process noise near q = 7; too large a q makes estimates cautious, too small a one makes them '
        'fail, and is the worse mistake.',
        CIRCLE,
        figure_2,
        plot_2,
        'Holds for a target that turns all the time; on straight legs a smaller q is better (A9).',
    ),
    Claim(
        'A2',
        'A',
        'section 3.1',
        'With q = 7 the error indicator is 9.2233 cm.',
        CIRCLE,
        level,
        remark='Path, nodes and start of the document are not told; ours is a circle of 13 cm at 6 cm/s.',
    ),
)
