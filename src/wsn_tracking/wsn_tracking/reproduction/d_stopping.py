"""A robot that stops dead: its runs, and how an error before and after the stop is measured."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.reproduction.claims import PICTURE, Bounds, Experiment, Figure, Plot, Samples
from wsn_tracking.reproduction.d_filters import EKF, HYBRID, IMM, LS, followed
from wsn_tracking.reproduction.quantities import bootstrapped, curve, path
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.hybrid_runs import sample

SETTLED = 2.0  # [s] after the start that are not scored
CLOSE = 0.04  # [m] an ensemble below this has settled
SOON = 2.0  # [s] after the stop in which filters are compared
QUIET, LIVELY = 0.001, 0.01  # [m^2/s^3] of the filter
PERIOD = CellsConfig().period


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


def settling_ratio(s: Samples, above: str, below: str, shape: Bounds | None) -> Figure:
    """How much longer one filter needs than another."""
    time = settling(stopped(s))
    return bootstrapped(
        f'settling, {above} / {below}', lambda v: time(v[0]) / time(v[1]), [s[above], s[below]], shape=shape
    )


def about_the_stop(s: Samples) -> slice:
    """The epochs that are drawn."""
    return slice(max(stopped(s) - 40, 0), stopped(s) + 80)


def by_time(s: Samples) -> Plot:
    """RMSE of all runs."""
    some = about_the_stop(s)
    time = (PERIOD * (np.arange(len(s[f'{PICTURE}truth'])) - stopped(s)))[some].tolist()
    lines = [curve(name, time, s[name][:, some], root=True, scale=100.0) for name in (LS, EKF, HYBRID, IMM)]
    return Plot('All runs', 'time after the stop [s]', 'RMSE [cm]', lines)


def one_run(s: Samples) -> Plot:
    """Tracks of one run."""
    some = about_the_stop(s)
    tracks = [path(name, s[f'{PICTURE}{name}'][some]) for name in (LS, EKF, HYBRID)]
    truth = path('truth', s[f'{PICTURE}truth'][some], 'truth')
    return Plot('One run about the stop', 'x [m]', 'y [m]', [truth, *tracks], equal=True)
