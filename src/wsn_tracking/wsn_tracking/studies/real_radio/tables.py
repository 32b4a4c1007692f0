"""One table a recording: RMSE and NEES of 2-D position with each switch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from wsn_tracking.configuration import load_configuration
from wsn_tracking.parameters import Values
from wsn_tracking.studies.intervals import known
from wsn_tracking.studies.real_radio.scores import figures, pooled
from wsn_tracking.studies.real_radio.sets import Bags, Sets
from wsn_tracking.studies.results import Result

# What is switched off at first, and then on again in this order.
OFF: Mapping[str, Any] = {
    'noise.velocity_time': 0.0,
    'update.kind': 'ckf',
    'robust.dof': 0.0,
    'robust.offset_std': 0.0,
    'update.kappa': 0.0,
}
LADDER = (
    ('gaussian_ckf', ()),
    ('forgotten_velocity', ('noise.velocity_time',)),
    ('iterated', ('noise.velocity_time', 'update.kind')),
    ('student_t', ('noise.velocity_time', 'update.kind', 'robust.dof')),
    ('drifting_offsets', ('noise.velocity_time', 'update.kind', 'robust.dof', 'robust.offset_std')),
)
KAPPA = {'update.kappa': 2.0}
GATE = {'robust.gate': 3.0, 'reacquire.rejects': 8}
STUDENT_T = {'robust.dof': 5.0, 'update.kind': 'iplf'}
DENSITIES = (0.01, 0.03, 0.1, 0.3, 1.0)  # [m^2/s^3] that every rung of the ladder may choose from


def central(bags: Bags, configuration: str, settings: Values) -> Result:
    """Figures of one estimator that hears all nodes."""
    return figures(pooled(bags, configuration, {**settings, 'peers': [1]})['local_1'])


def of_signal_strengths(bags: Bags, configuration: str) -> Result:
    """The ladder from a Gaussian cubature filter up, calibrations, and what was tried and not taken."""
    rungs = {name: {k: v for k, v in OFF.items() if k not in back} for name, back in LADDER}
    rungs['kappa_2'] = KAPPA
    result = {}
    for name, settings in rungs.items():
        best = best_of_densities(bags, configuration, settings)
        result[name] = {**central(bags, configuration, settings), 'best_of_densities': best}
    others: Mapping[str, Values] = {
        'as_configured': {},
        'calibrated_path_loss': {'channel': bags.channel},
        'radio_map': {'channel': bags.with_map},
        'tried_gate_3': GATE,
        'tried_without_area': {'area': []},
    }
    kept = {'noise.velocity_time': 0.0, 'channel': bags.with_map}
    return {
        **result,
        **{name: central(bags, configuration, settings) for name, settings in others.items()},
        'tried_radio_map_velocity_kept': best_of_densities(bags, configuration, kept),
    }


def best_of_densities(bags: Bags, configuration: str, settings: Values) -> Result:
    """Figures with the spectral density of DENSITIES that suits the settings best."""
    tried = {d: central(bags, configuration, {**settings, 'noise.spectral_density': d}) for d in DENSITIES}
    best = min(tried, key=lambda d: float(tried[d]['rmse_m']))
    return {'spectral_density': best, **tried[best]}


def of_ranges(bags: Bags, configuration: str) -> Result:
    """With and without calibration, and what was tried on top of it."""
    calibrated = {'channel': bags.channel}
    rows: Mapping[str, Values] = {
        'uncalibrated': {},
        'calibrated': calibrated,
        'tried_student_t': {**calibrated, **STUDENT_T},
        'tried_gate_3': {**calibrated, **GATE},
    }
    told = load_configuration(configuration).of('estimator_1')
    return {
        'range_std_m': told['update.range_std'],
        'scored_from_s': bags.skip_s,
        **{name: central(bags, configuration, settings) for name, settings in rows.items()},
    }


def of_three(bags: Bags, configuration: str) -> Result:
    """Three estimators that hear four receivers each, with and without feedback, and with the map."""
    rows: Mapping[str, Values] = {
        'feedback': {},
        'no_feedback': {'fusion.feedback': False},
        'radio_map': {'channel': bags.with_map},
    }
    result = {}
    for name, settings in rows.items():
        outputs = pooled(bags, configuration, settings)
        alone = [outputs[f'local_{i}'].rmse_m for i in (1, 2, 3)]
        result[name] = {
            'local_rmse_m': [known(value) for value in alone],
            'mean_of_the_locals_rmse_m': known(float(np.mean(alone))),
            'fused': figures(outputs['fused_1']),
        }
    return result


def danis_central(sets: Sets) -> Result:
    """BLE beacon in a flat, all receivers; radios: the survey; else tuned on the four tracks that are scored."""
    return of_signal_strengths(sets.bags('danis'), 'danis_central')


def danis_three(sets: Sets) -> Result:
    """The same with four receivers an estimator; tuned on the four tracks that are scored."""
    return of_three(sets.bags('danis'), 'danis_three')


def kolakowski(sets: Sets) -> Result:
    """BLE tag on a robot; radios: the survey; the rest was tuned on the robot track that is scored."""
    return of_signal_strengths(sets.bags('kolakowski'), 'kolakowski')


def lias(sets: Sets) -> Result:
    """UWB on a trolley; radios: the first 15 s, which are not scored."""
    return of_ranges(sets.bags('lias'), 'lias')


def plaza2(sets: Sets) -> Result:
    """Radio beacons and a lawnmower; radios: the first 100 s (a quarter), which are not scored."""
    return of_ranges(sets.bags('plaza2'), 'plaza')


def labyrinth(sets: Sets) -> Result:
    """UWB through walls; radios: the first 10 s (a third), which are not scored."""
    return of_ranges(sets.bags('labyrinth'), 'labyrinth')


TABLES: Mapping[str, Callable[[Sets], Result]] = {
    'danis_central': danis_central,
    'danis_three': danis_three,
    'kolakowski': kolakowski,
    'lias': lias,
    'plaza2': plaza2,
    'labyrinth': labyrinth,
}
