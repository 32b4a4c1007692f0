"""System C on real signal strengths: what each part of its model is worth, and how far its setting was tuned."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from wsn_tracking.evaluation.score import pool
from wsn_tracking.parameters import Values
from wsn_tracking.studies.real_radio.left_out import left_out
from wsn_tracking.studies.real_radio.scores import Scores, figures, of_tracks
from wsn_tracking.studies.real_radio.sets import SETS, Bags, Sets, find
from wsn_tracking.studies.results import Result

OUTPUTS = ('human', 'human_lag')
NORMAL = {'signal.dof': 0.0, 'signal.sigma': 6.0}  # the best of 5, 6 and 7 dB
NO_OFFSETS = {'signal.offset_std': 0.0}
PLAIN = {'signal.kind': 'profile', **NO_OFFSETS}
LADDER: Mapping[str, Values] = {
    'one_curve_normal': {**NORMAL, **NO_OFFSETS},
    'student_t': NO_OFFSETS,
    'as_configured': {},
    'tried_walk': {'motion.kind': 'walk', 'motion.slowest': 0.05, 'motion.fastest': 1.5},
    'tried_body': PLAIN,
    'tried_2000_particles': {'particles': 2000},
    'tried_200_particles': {'particles': 200},
}
SEEDS = (0, 1, 2, 3, 4)
# Settings that leaving one track out chooses from.
NOISES = ((3.0, 4.0), (4.0, 4.5), (5.0, 5.0))  # degrees of freedom, [dB]
OFFSETS = ((2.0, 3.0), (2.5, 5.0), (3.0, 10.0))  # [dB], [s]
STEPS = (0.5, 0.7, 0.9)  # [m/sqrt(s)]


def told(scores: Scores, titles: Sequence[str]) -> Result:
    """Pooled figures of each output, and the RMSE of every track."""
    result: Result = {}
    for output in OUTPUTS:
        each = [score[output] for score in scores]
        result[output] = figures(pool(each))
        if len(each) > 1:
            result[output]['of_tracks_m'] = {t: round(s.rmse_m, 3) for t, s in zip(titles, each, strict=True)}
    return result


def ladder(bags: Bags, configuration: str, channels: Mapping[str, Values]) -> Result:
    """Every rung with every channel."""
    titles = [source.title for source, _ in bags.opened]
    return {
        channel: {
            rung: told(of_tracks(bags, configuration, {**given, **settings}), titles)
            for rung, settings in LADDER.items()
        }
        for channel, given in channels.items()
    }


def spread(bags: Bags, configuration: str, channel: Values) -> Result:
    """Pooled RMSE over seeds of the filter's draws."""
    found = [of_tracks(bags, configuration, {**channel, 'seed': seed}) for seed in SEEDS]
    result = {}
    for output in OUTPUTS:
        errors = [pool([score[output] for score in scores]).rmse_m for scores in found]
        result[output] = {
            'mean_m': round(float(np.mean(errors)), 3),
            'least_m': round(min(errors), 3),
            'most_m': round(max(errors), 3),
        }
    return result


def candidates() -> Mapping[str, Values]:
    """Settings about the configured one."""
    return {
        f'dof {dof:g}, {sigma:g} dB, offsets {std:g} dB {time:g} s, step {step:g}': {
            'signal.dof': dof,
            'signal.sigma': sigma,
            'signal.offset_std': std,
            'signal.offset_time': time,
            'motion.step': step,
        }
        for (dof, sigma), (std, time), step in itertools.product(NOISES, OFFSETS, STEPS)
    }


def _channels(bags: Bags) -> dict[str, Values]:
    return {'path_loss': {'channel': bags.channel}, 'radio_map': {'channel': bags.with_map}}


def danis_human(sets: Sets) -> Result:
    """BLE beacon in a flat, start unknown; radios and map: the survey alone; else tuned on the four tracks scored."""
    bags = sets.bags('danis')
    result = ladder(bags, 'human_danis', _channels(bags))
    for channel, given in _channels(bags).items():
        result[channel]['seeds'] = spread(bags, 'human_danis', given)
    return result


def danis_human_left_out(sets: Sets) -> Result:
    """The same, each track with the setting that the three others would have chosen."""
    bags = sets.bags('danis')
    return left_out(bags, 'human_danis', _channels(bags), candidates(), OUTPUTS)


def kolakowski_human(sets: Sets) -> Result:
    """BLE tag on a robot with the setting of the carried beacon; radios and map: the survey; walls: layout.csv."""
    bags = sets.bags('kolakowski')
    (plan,) = find(sets.data, SETS['kolakowski']).rglob('layout.csv')
    walls = {'floor_plan': str(plan)}
    channels: dict[str, Values] = {'as_imported': {}, **_channels(bags)}
    with_walls = {f'{name}_walls': {**given, **walls} for name, given in channels.items()}
    titles = [source.title for source, _ in bags.opened]
    return {
        name: told(of_tracks(bags, 'human_kolakowski', given), titles)
        for name, given in {**channels, **with_walls}.items()
    }


TABLES: Mapping[str, Callable[[Sets], Result]] = {
    'danis_human': danis_human,
    'danis_human_left_out': danis_human_left_out,
    'kolakowski_human': kolakowski_human,
}
