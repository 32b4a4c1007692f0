"""The long runs of system A: what seed 000 measures, with many runs and intervals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from wsn_tracking.evaluation.metrics import ei
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import range_function, relative_noise
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies import random_q_runs as runs_of
from wsn_tracking.studies.intervals import mean_of, ratio_of, short
from wsn_tracking.studies.reference import posterior_means
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, UpdateConfig

ALPHAS = (0.2, 0.25, 0.27, 0.3, 0.5)  # weights of the event trigger's pre-filter
UPDATES = {
    'ckf_measured': UpdateConfig(kind='ckf', r='measured'),
    'ckf_predicted': UpdateConfig(kind='ckf', r='predicted'),
    'iplf_predicted': UpdateConfig(kind='iplf', r='predicted'),
    'log': UpdateConfig(kind='log'),
}


def trigger_rate(runs: int = 1000, seed: int = 1) -> Result:
    """Share of the signals in radius that the event trigger sends on a_loop, by the weight of its pre-filter."""
    shares = {f'alpha_{alpha:g}': ratio_of(*signals(alpha, runs, seed)) for alpha in ALPHAS}
    return {'runs': runs, 'seed': seed, 'sent_of_in_radius': shares}


def signals(alpha: float, runs: int, seed: int) -> tuple[Floats, Floats]:
    """How many signals of each run (runs,) on a_loop the event trigger sends, and how many are in radius."""
    L = scenario('a_loop')
    step = trigger.event(trigger.EventThresholds(alpha=alpha))
    sensed = runs_of.sense(L, runs_of.repeated(L, runs), step, np.random.default_rng(seed))
    sent, heard = (np.sum(mask, axis=(1, 2)) for mask in (sensed.verdicts == trigger.SENT, runs_of.in_radius(sensed)))
    return sent.astype(np.float64), heard.astype(np.float64)


def update_forms(runs: int = 1000, seed: int = 1) -> Result:
    """Error indicator of one filter with q = 7 on a_loop: noise at the measured or predicted range, iterated, log."""
    L, generator = scenario('a_loop'), np.random.default_rng(seed)
    step = trigger.event(trigger.EventThresholds(alpha=L.alpha))
    sensed = runs_of.sense(L, runs_of.repeated(L, runs), step, generator)
    start = runs_of.start_near(sensed.states, generator)
    eis, nees = {}, {}
    for name, update in UPDATES.items():
        config = RandomQConfig(noise=NoiseConfig(q_min=7.0, q_max=7.0), update=update)
        tracks = runs_of.track(L, sensed, start, config)
        eis[name] = ei(runs_of.errors(tracks, sensed))[:, 0]
        nees[name] = mean_of(np.mean(runs_of.position_nees(tracks, sensed), axis=(1, 2)))
    document = eis['ckf_measured']
    return {
        'runs': runs,
        'seed': seed,
        'ei_cm': {name: mean_of(value, 100.0) for name, value in eis.items()},
        'ei_of_ckf_measured': {name: ratio_of(value, document) for name, value in eis.items() if value is not document},
        'position_nees': nees,
    }


def matched_model(
    runs: int = 2000, epochs: int = 20, seed: int = 2, reference_runs: int = 150, particles: int = 5000
) -> Result:
    """Consistency (NEES of 2-D position, 2 is right) and distance to the optimum where the model is true.

    Walks are the filter's own white acceleration, kept in the field; every node is heard. Less than one run in a
    hundred takes the wrong side of a node that it passes closely, where two places fit all ranges: those few dominate
    the mean NEES, which is also given without the worst hundredth of the runs.
    """
    result: Result = {
        'runs': runs,
        'epochs': epochs,
        'seed': seed,
        'particles': particles,
        'runs_of_the_particle_filter': reference_runs,
    }
    for density in (0.25e-4, 2e-4, 8e-4):
        result[f'spectral_density_{density * 1e4:g}_cm2_s3'] = _matched(
            density, runs, epochs, reference_runs, particles, np.random.default_rng(seed)
        )
    return result


class Matched(NamedTuple):
    """Runs whose model is exactly true, by form of the update."""

    best: Floats  # (reference_runs,) mean squared position error of the particle filter [m^2]
    squares: Mapping[str, Floats]  # (runs,) the same of each form
    nees: Mapping[str, Floats]  # (runs,)


def matched_runs(
    density: float, runs: int, epochs: int, reference_runs: int, particles: int, generator: np.random.Generator
) -> Matched:
    """Every form of the update on walks of that spectral density [m^2/s^3], and many particles on some of them."""
    L = scenario('a_loop')
    sensed = runs_of.sense(L, runs_of.walks_inside(L, density, epochs, runs, generator), trigger.always(), generator)
    start = runs_of.start_near(sensed.states, generator)
    some = slice(0, reference_runs)
    h = range_function(L.anchors)
    means = posterior_means(
        start._replace(m=start.m[some], chol_P=start.chol_P[some]),
        constant_velocity(L.period),
        white_acceleration(density, L.period),
        sensed.z[some],
        h,
        relative_noise(L.anchors, h),
        particles,
        generator,
    )
    best = np.mean(np.sum((means - sensed.states[some])[..., :2] ** 2, axis=-1), axis=-1)
    squares, nees = {}, {}
    noise = NoiseConfig(kind='acceleration', q_min=7.0, q_max=7.0, spectral_density=density)
    for name, update in UPDATES.items():
        tracks = runs_of.track(L, sensed, start, RandomQConfig(noise=noise, update=update))
        squares[name] = np.mean(np.sum(runs_of.errors(tracks, sensed) ** 2, axis=-1), axis=(1, 2))
        nees[name] = np.mean(runs_of.position_nees(tracks, sensed), axis=(1, 2))
    return Matched(best, squares, nees)


def _matched(
    density: float, runs: int, epochs: int, reference_runs: int, particles: int, generator: np.random.Generator
) -> Result:
    m = matched_runs(density, runs, epochs, reference_runs, particles, generator)
    usual = {name: np.sort(of_run)[: runs - runs // 100] for name, of_run in m.nees.items()}
    return {
        'rmse_cm': {name: short(100.0 * np.sqrt(np.mean(squares))) for name, squares in m.squares.items()},
        'rmse_of_the_particle_filters': {
            name: ratio_of(squares[:reference_runs], m.best, root=True) for name, squares in m.squares.items()
        },
        'position_nees': {name: mean_of(np.sort(of_run)) for name, of_run in m.nees.items()},
        'position_nees_without_the_worst_hundredth': {name: mean_of(of_run) for name, of_run in usual.items()},
    }
