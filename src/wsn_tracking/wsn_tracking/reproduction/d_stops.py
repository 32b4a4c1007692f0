"""Seed 001: least squares, Kalman filter and their hybrid on robots that stop dead and on robots in phase."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wsn_tracking.evaluation import phase_runs
from wsn_tracking.evaluation.bounds import path_bound, scalar_information
from wsn_tracking.evaluation.hybrid_runs import Runs, listened, sample, track
from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.reproduction.claims import BEYOND, PICTURE, Claim, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import bootstrapped, curve, mean, median, path, ratio, root_mean
from wsn_tracking.simulation.d_cells import CellsConfig, nodes
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig

SETTLED = 2.0  # [s] after the start that are not scored
CLOSE = 0.04  # [m] an ensemble below this has settled
SOON = 2.0  # [s] after the stop in which filters are compared
QUIET, LIVELY = 0.001, 0.01  # [m^2/s^3] of the filter
LS, EKF, HYBRID, IMM = 'least squares', 'EKF', 'hybrid', 'two models'


def filters(q: float) -> dict[str, HybridConfig]:
    """The filters that are compared."""
    base = HybridConfig(motion=MotionConfig(spectral_density=q))
    return {EKF: replace(base, form='ekf'), HYBRID: base, IMM: replace(base, form='imm')}


def errors(m: Floats, states: Floats) -> Floats:
    """Squared error of the position, (runs, K) [m^2]."""
    return np.asarray(np.sum((m[..., :2] - states[..., :2]) ** 2, axis=-1))


def followed(runs: Runs, q: float) -> Samples:
    """Squared errors (runs, K) [m^2] and NEES (of 2) of every filter, those of one that knows all, one run's tracks."""
    m = {LS: listened(runs, HybridConfig())[0]}
    samples: dict[str, Floats] = {f'{PICTURE}truth': runs.states[:, :2], 'bound': least(runs)}
    for name, config in filters(q).items():
        tracks = track(runs, config)
        m[name] = tracks.m
        e = (tracks.m - runs.states)[:, :, :2]
        samples[f'{name}: nees'] = np.nan_to_num(nees(e, tracks.P[..., :2, :2]))
    for name, states in m.items():
        samples[name] = np.nan_to_num(errors(states, runs.states), nan=0.0)
        samples[f'{PICTURE}{name}'] = states[0, :, :2]
    return samples


def least(runs: Runs) -> Floats:
    """Mean squared error (runs, K) [m^2] of a filter that is linearised at the truth and knows when a robot turns.

    It knows how it goes on as well, but for the one velocity after a change, that may be anything.
    """
    states, T = runs.states, runs.config.period
    heard = ~np.isnan(runs.told.z)
    weights = heard[..., None] * (runs.told.rows[..., None] == np.arange(len(nodes().ids))) / runs.config.range_std**2
    changes = np.any(np.abs(np.diff(states[:, 2:], axis=0)) > 1e-9, axis=-1)
    Q = np.zeros((len(states), 4, 4))
    Q[:-1][changes] = np.diag([0.0, 0.0, 1.0, 1.0])
    information = scalar_information(nodes().positions, states[None, :], weights)
    P = path_bound(np.eye(4), constant_velocity(T), Q, information)
    return np.asarray(np.trace(P[..., :2, :2], axis1=-2, axis2=-1))


def stop(name: str, q: float, dropout: float, seed: int, runs: int) -> Samples:
    """A robot that stops dead, by name of the scenario."""
    config = CellsConfig(dropout=dropout)
    states = scenario(name).truth
    return {
        **followed(sample(config, states, runs, seed), q),
        f'{PICTURE}stop': np.array([np.flatnonzero(np.any(states[:, 2:] != 0.0, axis=-1))[-1] + 1]),
    }


ARC = Experiment('d arc', partial(stop, 'd_arc_stop', QUIET, 0.0), runs=60, units=10, quick=2)
LINE = Experiment('d line', partial(stop, 'd_stop', QUIET, 0.0), runs=60, units=10, quick=3)
FREE = Experiment('d lively', partial(stop, 'd_stop', LIVELY, 0.0), runs=60, units=10, quick=2)
LOST = Experiment('d lost', partial(stop, 'd_stop', QUIET, 0.3), runs=60, units=10, quick=2)
PERIOD = CellsConfig().period


def stopped(s: Samples) -> int:
    """Epoch of the stop."""
    return int(s[f'{PICTURE}stop'][0])


def before(s: Samples, name: str) -> Floats:
    """Mean squared error (runs,) from when filters have settled until the stop."""
    return np.asarray(s[name][:, round(SETTLED / PERIOD) : stopped(s)].mean(axis=-1))


def soon(s: Samples, name: str) -> Floats:
    """Mean squared error (runs,) in the first two seconds after the stop."""
    return np.asarray(s[name][:, stopped(s) : stopped(s) + round(SOON / PERIOD)].mean(axis=-1))


def settling(at: int) -> Callable[[Floats], float]:
    """Last time [s] after the stop at which the ensemble (K,) is further off than CLOSE; a period at least."""

    def time(squares: Floats) -> float:
        far = np.flatnonzero(squares[at:] > CLOSE**2)
        return PERIOD * (float(far[-1]) + 1.0 if far.size else 1.0)

    return time


def settling_ratio(s: Samples, above: str, below: str, shape: tuple[float | None, float | None] | None) -> Figure:
    """How much longer one filter needs than another."""
    time = settling(stopped(s))
    return bootstrapped(
        f'settling, {above} / {below}', lambda v: time(v[0]) / time(v[1]), [s[above], s[below]], shape=shape
    )


def table_1(s: Samples) -> Sequence[Figure]:
    """Least squares and EKF, each with its fault."""
    return [
        ratio(f'RMSE before the stop, {LS} / {EKF}', before(s, LS), before(s, EKF), True, shape=(1.5, None)),
        settling_ratio(s, EKF, LS, (1.5, None)),
    ]


def figure_4(s: Samples) -> Sequence[Figure]:
    """The hybrid: the EKF's smoothness before the stop, nearly the quickness of least squares after it."""
    time = settling(stopped(s))
    return [
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(0.9, 1.1)),
        ratio(f'RMSE before the stop, {LS} / {HYBRID}', before(s, LS), before(s, HYBRID), True, shape=(1.2, None)),
        settling_ratio(s, EKF, HYBRID, (1.8, None)),
        settling_ratio(s, HYBRID, LS, (1.0, None)),
        ratio(f'RMSE 2 s after the stop, {EKF} / {HYBRID}', soon(s, EKF), soon(s, HYBRID), True, shape=(1.5, None)),
        *(bootstrapped(f'settling, {n}', lambda v: time(v[0]), [s[n]], 's') for n in (LS, HYBRID, EKF)),
    ]


def on_an_arc(s: Samples) -> Sequence[Figure]:
    """On a path that the motion model does not know, the EKF is slow all the time."""
    return [
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {LS} / {HYBRID}', before(s, LS), before(s, HYBRID), True, shape=(1.2, None)),
        settling_ratio(s, EKF, HYBRID, (2.0, None)),
        settling_ratio(s, HYBRID, LS, (1.0, None)),
        ratio(f'RMSE 2 s after the stop, {EKF} / {HYBRID}', soon(s, EKF), soon(s, HYBRID), True, shape=(1.5, None)),
    ]


def lively(s: Samples) -> Sequence[Figure]:
    """With ten times the process noise there is less to win."""
    return [
        ratio(f'RMSE 2 s after the stop, {HYBRID} / {EKF}', soon(s, HYBRID), soon(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.1)),
        settling_ratio(s, EKF, HYBRID, None),
    ]


def plot_4(s: Samples) -> Sequence[Plot]:
    """Tracks of one run, and the ensemble by time."""
    at = stopped(s)
    some = slice(max(at - 40, 0), at + 80)
    time = (PERIOD * (np.arange(len(s[f'{PICTURE}truth'])) - at))[some].tolist()
    names = (LS, EKF, HYBRID, IMM)
    tracks = [path(name, s[f'{PICTURE}{name}'][some]) for name in names[:3]]
    truth = path('truth', s[f'{PICTURE}truth'][some], 'truth')
    lines = [curve(name, time, s[name][:, some], root=True, scale=100.0) for name in names]
    return [
        Plot('One run about the stop', 'x [m]', 'y [m]', [truth, *tracks], equal=True),
        Plot('All runs', 'time after the stop [s]', 'RMSE [cm]', lines),
    ]


# ---- figure 5: two robots in phase


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


LASTS = 40.0  # [s]
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


# ---- beyond


def two_models(s: Samples) -> Sequence[Figure]:
    """Two models at once against the hybrid."""
    return [
        ratio(f'RMSE 2 s after the stop, {IMM} / {HYBRID}', soon(s, IMM), soon(s, HYBRID), True, shape=(None, 1.0)),
        ratio(f'RMSE before the stop, {IMM} / {HYBRID}', before(s, IMM), before(s, HYBRID), True),
        settling_ratio(s, IMM, HYBRID, None),
        *(
            ratio(f'RMSE 2 s after the stop, {n} / best', soon(s, n), soon(s, 'bound'), True)
            for n in (LS, EKF, HYBRID, IMM)
        ),
        *(median(f'NEES (of 2) before the stop, {n}', before(s, f'{n}: nees')) for n in (EKF, HYBRID, IMM)),
        *(median(f'NEES (of 2) 2 s after it, {n}', soon(s, f'{n}: nees')) for n in (EKF, HYBRID, IMM)),
    ]


def dropouts(s: Samples) -> Sequence[Figure]:
    """With ranges that are lost."""
    return [
        ratio(f'RMSE 2 s after the stop, {HYBRID} / {EKF}', soon(s, HYBRID), soon(s, EKF), True, shape=(None, 1.1)),
        ratio(f'RMSE before the stop, {HYBRID} / {EKF}', before(s, HYBRID), before(s, EKF), True, shape=(None, 1.15)),
        ratio(f'RMSE 2 s after the stop, {IMM} / {HYBRID}', soon(s, IMM), soon(s, HYBRID), True),
    ]


CLAIMS = (
    Claim(
        'D1',
        'D',
        'table 1',
        'Least squares follows at once but is noisy; the Kalman filter is smooth but slow to settle.',
        LINE,
        table_1,
        remark='The cells of the table are lost; the text around it says this.',
    ),
    Claim(
        'D2',
        'D',
        'figure 4',
        'At a sudden stop between two cells, the hybrid is as smooth as the Kalman filter before the stop and far '
        'quicker after it, if not as quick as least squares.',
        LINE,
        figure_4,
        plot_4,
        'A straight line at 0.5 m/s. Settling: the last time at which the RMSE over all runs exceeds 4 cm. Process '
        'noise 0.001 m^2/s^3; the document does not tell its own.',
    ),
    Claim(
        'D3',
        'D',
        'figure 4',
        'So it is on the path of the document, an arc at 0.5 rad/s.',
        ARC,
        on_an_arc,
        plot_4,
        'A stiff Kalman filter that knows no turns is off on the whole arc; the hybrid takes the turn for a '
        'manoeuvre, and is better before the stop, too.',
    ),
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
    Claim(
        'D21',
        'D',
        'two models',
        'Two motion models that run at once (imm) are better after a stop than the hybrid, without thresholds.',
        LINE,
        two_models,
        plot_4,
        'On a straight line at 0.5 m/s. The price: between manoeuvres its track is noisier. Best: a filter that knows '
        'when the robot stops and all else but how fast it goes on (Cramer-Rao recursion). All filters hear the same '
        'range a period: 20 messages of 18 bytes a second.',
        kind=BEYOND,
    ),
    Claim(
        'D23',
        'D',
        'process noise',
        'With ten times the process noise, where the Kalman filter is quick itself, the hybrid does no harm.',
        FREE,
        lively,
        kind=BEYOND,
    ),
    Claim(
        'D22',
        'D',
        'lost ranges',
        'With 30 % of the ranges lost, the hybrid is no worse than the Kalman filter.',
        LOST,
        dropouts,
        remark='It asks least squares only where its ranges are fresh; without that, lost ranges ruin it.',
        kind=BEYOND,
    ),
)
