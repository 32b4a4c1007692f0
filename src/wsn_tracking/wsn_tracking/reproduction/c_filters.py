"""Seed 003: filters over the same walks, and how their errors are told."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import PICTURE, Bounds, Figure, Plot, Samples
from wsn_tracking.reproduction.quantities import path, ratio
from wsn_tracking.studies.human_runs import SETTLED, Walks, distances, track
from wsn_tracking.trackers.human_config import HumanConfig

REACH = 50.0  # [m] what the document divides errors by
PAPER, ONE = 'two curves', 'RSS-MCL'


def compared(configs: dict[str, HumanConfig], walks: Walks, seed: int) -> Samples:
    """Mean squared errors (runs,) [m^2] and NEES (of 2) of each filter, and its track of the first run."""
    samples: dict[str, Floats] = {f'{PICTURE}truth': walks.states[0, :, :2]}
    after = walks.times >= SETTLED
    for name, config in configs.items():
        tracks = track(config, walks, seed)
        e = (tracks.mean - walks.states)[:, after, :2]
        samples[f'{name}: nees'] = np.nanmean(nees(e, tracks.covariance[:, after, :2, :2]), axis=-1)
        samples[name] = np.nanmean(distances(tracks, walks)[:, after] ** 2, axis=-1)
        samples[f'{PICTURE}{name}'] = tracks.mean[0, after, :2]
    return samples


def maps(title: str, s: Samples, names: Sequence[str]) -> Plot:
    """One run."""
    tracks = [path(name, s[f'{PICTURE}{name}']) for name in names]
    return Plot(title, 'x [m]', 'y [m]', [path('truth', s[f'{PICTURE}truth'], 'truth'), *tracks], equal=True)


def better(
    s: Samples,
    told: float,
    shape: Bounds,
    near: tuple[float, float],
    names: tuple[str, str] = (PAPER, ONE),
) -> Figure:
    """By how many percent the RMSE of one filter lies below that of another."""
    found = ratio('', s[names[0]], s[names[1]], True).ours
    value, ends = np.asarray(found['value']), np.asarray(found['interval_95'])
    ours = {'value': float(100.0 * (1.0 - value)), 'interval_95': (100.0 * (1.0 - ends[::-1])).tolist()}
    return Figure(f'{names[0]} better than {names[1]} by', ours, '%', told, shape, near)
