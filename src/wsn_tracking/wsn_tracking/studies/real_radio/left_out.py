"""Whether settings that were chosen on some tracks serve another one, and how much the choice matters at all."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

from wsn_tracking.evaluation.score import pool
from wsn_tracking.parameters import Values
from wsn_tracking.studies.real_radio.scores import of_tracks
from wsn_tracking.studies.real_radio.sets import Bags, Sets
from wsn_tracking.studies.results import Result

# About what `danis_central` has: half and twice as much, a decibel less and more.
DENSITIES = (0.25, 0.5, 1.0)  # [m^2/s^3]
TIMES = (1.0, 2.0, 4.0)  # [s] after which a velocity is forgotten
OFFSETS = (2.5, 3.5, 4.5)  # [dB]


def left_out(
    bags: Bags,
    configuration: str,
    channels: Mapping[str, Values],
    candidates: Mapping[str, Values],
    outputs: Sequence[str],
) -> Result:
    """Each track with the setting that is best on the others, by the sum of the pooled RMSE of outputs and channels.

    `least` and `most` are the pooled RMSE of the best and of the worst of all candidates on all tracks.
    """
    found = {
        name: {channel: of_tracks(bags, configuration, {**given, **setting}) for channel, given in channels.items()}
        for name, setting in candidates.items()
    }

    def cost(name: str, kept: Sequence[int]) -> float:
        return sum(
            pool([scores[i][output] for i in kept]).rmse_m for scores in found[name].values() for output in outputs
        )

    every = range(len(bags.opened))
    chosen = [min(found, key=lambda name: cost(name, [k for k in every if k != i])) for i in every]
    result: Result = {'chosen': {bags.opened[i][0].title: name for i, name in enumerate(chosen)}}
    for channel in channels:
        result[channel] = {}
        for output in outputs:
            all_ = [pool([scores[i][output] for i in every]).rmse_m for scores in (f[channel] for f in found.values())]
            apart = pool([found[name][channel][i][output] for i, name in enumerate(chosen)]).rmse_m
            result[channel][output] = {
                'rmse_m': round(apart, 3),
                'least_m': round(min(all_), 3),
                'most_m': round(max(all_), 3),
            }
    return result


def candidates() -> Mapping[str, Values]:
    """Settings about the one of `danis_central`."""
    return {
        f'S {S:g} m^2/s^3, velocities {time:g} s, offsets {std:g} dB': {
            'noise.spectral_density': S,
            'noise.velocity_time': time,
            'robust.offset_std': std,
        }
        for S, time, std in itertools.product(DENSITIES, TIMES, OFFSETS)
    }


def danis_left_out(sets: Sets) -> Result:
    """`danis_central`, each track with the setting that the three others would have chosen."""
    bags = sets.bags('danis')
    alone: Values = {'peers': [1]}
    channels: Mapping[str, Values] = {'path_loss': alone, 'radio_map': {**alone, 'channel': bags.with_map}}
    return left_out(bags, 'danis_central', channels, candidates(), ('local_1',))


TABLES = {'danis_left_out': danis_left_out}
