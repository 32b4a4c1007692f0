"""Seed 001, figure 5: two robots in phase, tracked, and steered by what the network tells them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import PICTURE, Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.d_filters import errors
from wsn_tracking.reproduction.d_stopping import PERIOD, SETTLED
from wsn_tracking.reproduction.quantities import curve, mean, path, ratio, root_mean
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies import phase_runs
from wsn_tracking.studies.hybrid_runs import sample, track
from wsn_tracking.trackers.hybrid_config import HybridConfig

LASTS = 40.0  # [s]


def phase(seed: int, runs: int) -> Samples:
    """Both robots of d_phase, each by its own filter."""
    both = scenario('d_phase')
    samples: dict[str, Floats] = {}
    for number, states in enumerate((both.truth, *both.companions), start=1):
        tracked = sample(CellsConfig(), states, runs, seed + number)
        m = track(tracked, HybridConfig()).m
        after = slice(round(SETTLED / PERIOD), None)
        samples[f'robot {number}'] = errors(m, states)[:, after].mean(axis=-1)
        centre = np.array(((1.0, 5.0), (2.0, 2.0))[number - 1])
        angle = np.unwrap(np.arctan2(*(m[:, after, :2] - centre)[..., ::-1].transpose(2, 0, 1)), axis=-1)
        samples[f'angle {number}'] = angle
        samples[f'{PICTURE}robot {number}'], samples[f'{PICTURE}truth {number}'] = m[0, :, :2], states[:, :2]
    return samples


PHASE = Experiment('d phase', phase, runs=20, units=8, quick=2)


def figure_5(s: Samples) -> Sequence[Figure]:
    """Accuracy, and how well phases agree as they are seen."""
    apart = np.std(s['angle 1'] - s['angle 2'], axis=-1)
    return [
        *(root_mean(f'RMSE, robot {n}', s[f'robot {n}'], 'cm', 100.0, shape=(None, 5.0)) for n in (1, 2)),
        mean('spread of the phase between them, as tracked', np.degrees(apart), 'deg', shape=(None, 5.0)),
    ]


def plot_5(s: Samples) -> Sequence[Plot]:
    """Both tracks of a run."""
    some = slice(40, None)
    tracks = [path(f'robot {n}', s[f'{PICTURE}robot {n}'][some]) for n in (1, 2)]
    truths = [path(f'truth {n}', s[f'{PICTURE}truth {n}'][some], 'truth') for n in (1, 2)]
    return [Plot('One run', 'x [m]', 'y [m]', [*truths, *tracks], equal=True)]


# ---- the whole loop


def loop(seed: int, runs: int) -> Samples:
    """The second robot drives by the tracks of both, which it is told over the network; it begins far behind."""
    config = phase_runs.PhaseConfig(cells=CellsConfig(lasts=LASTS))
    done = [phase_runs.run(config, seed % 2**31 + i) for i in range(runs)]
    after = done[0].times >= phase_runs.SETTLED_S
    return {
        'error': np.stack([r.error for r in done]),
        'squares': np.array([np.mean(r.error[after] ** 2) for r in done]),
        'begun': np.array([abs(r.error[0]) for r in done]),
        f'{PICTURE}times': done[0].times,
        f'{PICTURE}truth': done[0].truth[..., :2],
        f'{PICTURE}estimates': done[0].estimates,
    }


LOOP = Experiment('d loop', loop, runs=1, units=12, quick=4)


def in_phase(s: Samples) -> Sequence[Figure]:
    """The error in phase that is left, of that at first."""
    return [
        root_mean('phase error after 15 s', s['squares'], 'deg', 180.0 / np.pi, shape=(None, 8.0)),
        ratio('the same, of that at the start', s['squares'], s['begun'] ** 2, root=True, shape=(None, 0.1)),
    ]


def plot_phase(s: Samples) -> Sequence[Plot]:
    """Both tracks of a run, and all errors in phase."""
    tracks = [path(f'robot {n + 1}', s[f'{PICTURE}estimates'][n, 40:]) for n in range(2)]
    truths = [path(f'truth {n + 1}', s[f'{PICTURE}truth'][n, 40:], 'truth') for n in range(2)]
    error = curve('all runs', s[f'{PICTURE}times'].tolist(), np.degrees(s['error']))
    return [
        Plot('One run', 'x [m]', 'y [m]', [*truths, *tracks], equal=True),
        Plot('How far the second is behind', 't [s]', 'phase [deg]', [error]),
    ]


CLAIMS = (
    Claim(
        'D4',
        'D',
        'figure 5',
        'Two robots that circle in phase are tracked smoothly, through the changes of cells.',
        PHASE,
        figure_5,
        plot_5,
        'Robots on the circles of the document, with the 10 % of variation that it reports.',
        in_kind=True,
    ),
    Claim(
        'D5',
        'D',
        'figure 5',
        'Fed back over the network, these tracks keep the second robot in phase with the first.',
        LOOP,
        in_phase,
        plot_phase,
        'The second robot begins a third of a turn behind and is told both positions ten times a second, 60 ms late, '
        'in whole centimetres. The law by which it steers is ours; the document does not tell its own.',
        in_kind=True,
    ),
)
