"""The long runs of system E: what lost packets cost a turning target, by filter, rate and kind of loss (seed 004)."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.links import Loss
from wsn_tracking.studies import loss_runs
from wsn_tracking.studies.intervals import mean_of, ratio_of, short
from wsn_tracking.studies.loss_runs import Scores, Worlds
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig

FILTERS = ('ckf', 'ekf', 'ukf', 'hold')
RATES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
BURST = 10.0  # [epochs] mean length of a loss
LOST = 30.0  # [m] an estimate further off has lost its target: anchors are 27 m apart


def loss_rate(runs: int = 1000, seed: int = 1, rates: tuple[float, ...] = RATES) -> Result:
    """RMSE and consistency of each filter on e_loss by the rate of independent losses on each link."""
    worlds = loss_runs.sample(runs, seed)
    table = {f'loss_{p:g}': compared(worlds, Loss(p)) for p in rates}
    return {'runs': runs, 'seed': seed, 'by_rate': table}


def loss_kind(runs: int = 1000, seed: int = 1, rates: tuple[float, ...] = (0.3, 0.5, 0.7, 0.8)) -> Result:
    """The median run where losses come in bursts of 10 epochs or take whole rounds, and the share of lost tracks.

    Where whole rounds are lost, the few tracks that lose their target may end anywhere: a mean says nothing.
    """
    worlds = loss_runs.sample(runs, seed)
    table = {}
    for p in rates:
        kinds = {
            'independent': Loss(p),
            'bursts': Loss(p, BURST),
            'rounds': Loss(p, whole_round=True),
            'rounds_in_bursts': Loss(p, BURST, whole_round=True),
        }
        table[f'loss_{p:g}'] = {name: _typical(worlds, loss) for name, loss in kinds.items()}
    return {'runs': runs, 'seed': seed, 'by_rate_and_kind': table}


def _typical(worlds: Worlds, loss: Loss) -> Result:
    scores = {name: loss_runs.track(worlds, LossTolerantConfig(filter=name), loss) for name in FILTERS}
    return {
        'rmse_of_the_median_run_m': {name: short(np.sqrt(np.median(squares(s))), 4) for name, s in scores.items()},
        'nees_of_the_median_run': {name: short(median_nees(s), 4) for name, s in scores.items()},
        'lost_tracks': {name: short(np.mean(is_lost(s)), 4) for name, s in scores.items()},
    }


def compared(worlds: Worlds, loss: Loss) -> Result:
    """Every filter over the same runs and losses; ratios are of the RMSE of ckf."""
    scores = {name: loss_runs.track(worlds, LossTolerantConfig(filter=name), loss) for name in FILTERS}
    document = squares(scores['ckf'])
    return {
        'rmse_m': {name: short(rmse(s), 4) for name, s in scores.items()},
        'ckf_of': {name: ratio_of(document, squares(s), root=True) for name, s in scores.items() if name != 'ckf'},
        'nees_of_the_median_run': {name: short(median_nees(s), 4) for name, s in scores.items()},
        'nees': {name: mean_of(np.mean(s.nees, axis=1)) for name, s in scores.items()},
        'lost_tracks': {name: short(np.mean(is_lost(s)), 4) for name, s in scores.items()},
    }


def squares(scores: Scores) -> Floats:
    """Mean squared position error of each run (runs,) [m^2]."""
    return np.asarray(np.mean(np.sum(scores.errors**2, axis=-1), axis=-1))


def rmse(scores: Scores) -> float:
    """Over runs and epochs [m]."""
    return float(np.sqrt(np.mean(squares(scores))))


def median_nees(scores: Scores) -> float:
    """NEES of the 2-D position of the median run: one that loses its target outweighs all others in the mean."""
    return float(np.median(np.mean(scores.nees, axis=-1)))


def is_lost(scores: Scores) -> Floats:
    """Whether a run ends without its target, (runs,)."""
    return np.asarray(np.hypot(scores.errors[:, -1, 0], scores.errors[:, -1, 1]) > LOST)
