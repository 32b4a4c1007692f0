"""System D in its field of six cells: how fast it settles after a sudden stop, and what it costs before.

The filters alone, without the tracker's gate, but where it is said. The settling time is the last time at which the
ensemble's RMSE exceeds 4 cm after the stop; it is one number of all runs and has no interval.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies import hybrid_runs as runs_of
from wsn_tracking.studies.hybrid_runs import Runs
from wsn_tracking.studies.intervals import mean_of, ratio_of
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.hybrid_config import HybridConfig, MotionConfig, RobustConfig, StartConfig

SEED = 1
SETTLED_M = 0.04
BEGUN_S = 2.0  # a filter has settled in by then
AFTER_S = 2.0  # after the stop
DOCUMENT = HybridConfig(robust=RobustConfig(gate=0.0), start=StartConfig(position_std=1.0, velocity_std=1.0))  # P0 = I
FORMS = ('ekf', 'inflate', 'decay', 'imm')


def form(name: str, spectral_density: float, gate: float = 0.0) -> HybridConfig:
    """A form of the filter, begun with P0 = I."""
    motion, robust = MotionConfig(spectral_density=spectral_density), RobustConfig(gate=gate)
    return replace(DOCUMENT, form=name, motion=motion, robust=robust)


def world(name: str, runs: int, dropout: float = 0.0, seed: int = SEED) -> Runs:
    """A scenario, measured many times."""
    return runs_of.sample(CellsConfig(dropout=dropout), scenario(name).truth, runs, seed)


def squares(tracked: Floats, runs: Runs) -> Floats:
    """Squared position errors (runs, K) [m^2]; NaN where there is no estimate."""
    return np.asarray(np.sum(np.square(tracked[..., :2] - runs.states[:, :2]), axis=-1))


def all_squares(runs: Runs, spectral_density: float, gate: float = 0.0) -> dict[str, Floats]:
    """Of every form, and of least squares itself (ls) and low-passed (ls_low_passed)."""
    raw, smooth = runs_of.listened(runs, DOCUMENT)
    errors = {name: squares(runs_of.track(runs, form(name, spectral_density, gate)).m, runs) for name in FORMS}
    return {**errors, 'ls': squares(raw, runs), 'ls_low_passed': squares(smooth, runs)}


def stop_of(runs: Runs) -> int:
    """The first epoch at rest."""
    return int(np.flatnonzero(np.hypot(runs.states[:, 2], runs.states[:, 3]) == 0.0)[0])


def before(errors: Floats, runs: Runs) -> Floats:
    """Mean squared error of each run (runs,) before the stop."""
    return np.asarray(np.nanmean(errors[:, round(BEGUN_S / runs.config.period) : stop_of(runs)], axis=1))


def after(errors: Floats, runs: Runs) -> Floats:
    """Mean squared error of each run (runs,) in the first seconds after the stop."""
    stop = stop_of(runs)
    return np.asarray(np.nanmean(errors[:, stop : stop + round(AFTER_S / runs.config.period)], axis=1))


def settling(errors: Floats, runs: Runs) -> float:
    """How long the ensemble's RMSE last exceeds SETTLED_M after the stop [s]."""
    stop = stop_of(runs)
    beyond = np.flatnonzero(np.nanmean(errors[:, stop:], axis=0) > SETTLED_M**2)
    return float(beyond[-1] + 1) * runs.config.period if beyond.size else 0.0


def figures(errors: Mapping[str, Floats], runs: Runs) -> Result:
    """RMSE before and after the stop and settling times, and their ratios."""
    of_ekf, of_hybrid = errors['ekf'], errors['inflate']
    return {
        'rmse_cm_before': {name: _rmse(before(e, runs)) for name, e in errors.items()},
        'rmse_cm_2_s_after': {name: _rmse(after(e, runs)) for name, e in errors.items()},
        'settling_s': {name: round(settling(e, runs), 3) for name, e in errors.items()},
        'hybrid_of_ekf_before': ratio_of(before(of_hybrid, runs), before(of_ekf, runs), root=True),
        'ls_of_ekf_before': ratio_of(before(errors['ls'], runs), before(of_ekf, runs), root=True),
        'ekf_of_hybrid_2_s_after': ratio_of(after(of_ekf, runs), after(of_hybrid, runs), root=True),
        'imm_of_hybrid_2_s_after': ratio_of(after(errors['imm'], runs), after(of_hybrid, runs), root=True),
    }


def sudden_stop(runs: int = 1000) -> Result:
    """A sudden stop at the border of a cell: EKF, hybrid forms, two models and least squares on the same ranges."""
    result: Result = {'runs': runs, 'seed': SEED}
    for name in ('d_stop', 'd_arc_stop'):
        measured = world(name, runs)
        for density in (0.001, 0.01):
            errors = all_squares(measured, density)
            result[f'{name}, q_w = {density:g} m^2/s^3'] = figures(errors, measured)
    return result


def lost_ranges(runs: int = 500) -> Result:
    """Ranges that are lost, 30 % of them: the same stop, and a round through all cells that ends with one."""
    result: Result = {'runs': runs, 'seed': SEED}
    for name in ('d_stop', 'd_dropout'):
        measured = world(name, runs, 0.3)
        errors = all_squares(measured, 0.01)
        whole = {key: np.nanmean(e[:, round(BEGUN_S / measured.config.period) :], axis=1) for key, e in errors.items()}
        result[name] = {
            'rmse_cm': {key: _rmse(e) for key, e in whole.items()},
            'hybrid_of_ekf': ratio_of(whole['inflate'], whole['ekf'], root=True),
            'hybrid_of_ekf_2_s_after': ratio_of(
                after(errors['inflate'], measured), after(errors['ekf'], measured), root=True
            ),
        }
    return result


def gate(runs: int = 500) -> Result:
    """What the tracker's gate costs where no range is wrong: hybrid with it against hybrid without."""
    result: Result = {'runs': runs, 'seed': SEED, 'gate': HybridConfig().robust.gate}
    for density in (0.001, 0.01):
        measured = world('d_stop', runs)
        open_, shut = (
            squares(runs_of.track(measured, form('inflate', density, width)).m, measured)
            for width in (0.0, HybridConfig().robust.gate)
        )
        result[f'q_w = {density:g} m^2/s^3'] = {
            'settling_s': {'open': round(settling(open_, measured), 3), 'gate': round(settling(shut, measured), 3)},
            'gate_of_open_2_s_after': ratio_of(after(shut, measured), after(open_, measured), root=True),
        }
    return result


def frozen_gain(runs: int = 500) -> Result:
    """The document's frozen gain on ranges of all nodes at once, every period, against the EKF (q_w = 0.001)."""
    measured = world('d_stop', runs)
    config = form('literal', 0.001)
    errors = {
        name: squares(runs_of.track_together(measured, replace(config, manoeuvre=m), SEED), measured)
        for name, m in {
            'literal': config.manoeuvre,
            'ekf': replace(config.manoeuvre, threshold=1e6),
        }.items()
    }
    return {
        'runs': runs,
        'seed': SEED,
        'settling_s': {name: round(settling(e, measured), 3) for name, e in errors.items()},
        'rmse_cm_2_s_after': {name: _rmse(after(e, measured)) for name, e in errors.items()},
        'literal_of_ekf_before': ratio_of(
            before(errors['literal'], measured), before(errors['ekf'], measured), root=True
        ),
        'ekf_of_literal_2_s_after': ratio_of(
            after(errors['ekf'], measured), after(errors['literal'], measured), root=True
        ),
    }


def _rmse(mean_squares: Floats) -> Any:
    """Root of the mean of (runs,) [m^2] in cm, and its interval."""
    figure = mean_of(mean_squares, 1e4)
    return {name: np.round(np.sqrt(np.maximum(value, 0.0)), 4).tolist() for name, value in figure.items()}
