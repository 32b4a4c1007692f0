"""What process noise and fusion do to system A on a target that always turns (seed 000, section 3.1, its table 1)."""

from __future__ import annotations

from typing import Any

import numpy as np

from wsn_tracking.evaluation.metrics import ei
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies import random_q_runs as runs_of
from wsn_tracking.studies.intervals import change_of, mean_of, ratio_of
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, UpdateConfig

FIXED = (2.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0)
INTERVALS = ((2.0, 6.0), (4.0, 6.0), (8.0, 10.0), (8.0, 12.0), (2.0, 12.0), (4.0, 10.0), (6.0, 8.0))  # table 1
RULES = ('trace', 'mean', 'lci')
SOUGHT = ('optimal', 'ici')  # rules that search for their weights, and take some hundred times as long
ESTIMATORS = 3


def identity_noise(q_min: float, q_max: float, r: str = 'measured') -> RandomQConfig:
    """The document's filter with q ~ U[q_min, q_max]; r as it has it, or `predicted`."""
    return RandomQConfig(noise=NoiseConfig(q_min=q_min, q_max=q_max), update=UpdateConfig(r=r))


class Circle:
    """Runs of a_circle that every variant tracks: the same readings, starts and draws."""

    def __init__(self, runs: int, seed: int) -> None:
        generator = np.random.default_rng(seed)
        self.scenario = scenario('a_circle')
        step = trigger.event(trigger.EventThresholds(alpha=self.scenario.alpha))
        self.sensed = runs_of.sense(self.scenario, runs_of.repeated(self.scenario, runs), step, generator)
        self.start = runs_of.start_near(self.sensed.states, generator)
        self.uniform = generator.random((runs, ESTIMATORS, len(self.scenario.truth)))

    def fixed(self, q: float, r: str = 'measured') -> Floats:
        """EI (runs,) [m] of one filter whose q is fixed."""
        tracks = runs_of.track(self.scenario, self.sensed, self.start, identity_noise(q, q, r))
        return ei(runs_of.errors(tracks, self.sensed))[:, 0]

    def drawn(self, interval: tuple[float, float], r: str = 'measured') -> runs_of.Tracks:
        """Three filters whose q is drawn from an interval."""
        return runs_of.track(self.scenario, self.sensed, self.start, identity_noise(*interval, r), self.uniform)

    def local(self, tracks: runs_of.Tracks) -> Floats:
        """EI (runs,) [m] of the estimators on the average."""
        return np.asarray(ei(runs_of.errors(tracks, self.sensed)).mean(axis=1))

    def fused(self, tracks: runs_of.Tracks, rule: str, runs: int | None = None) -> Floats:
        """EI (runs,) [m] of their fusion; `runs`: of the first so many runs alone."""
        some = slice(0, runs)
        sensed = self.sensed._replace(states=self.sensed.states[some])
        chosen = runs_of.Tracks(*(column[some] for column in tracks))
        return ei(runs_of.errors(runs_of.fuse(chosen, rule), sensed))[:, 0]


def process_noise(runs: int = 1000, seed: int = 1) -> Result:
    """Error indicator of one filter on a_circle by its fixed q (figure 2 of the document)."""
    circle = Circle(runs, seed)
    result: Result = {'runs': runs, 'seed': seed}
    for r in ('measured', 'predicted'):
        eis = {q: circle.fixed(q, r) for q in FIXED}
        result[f'ckf_{r}'] = {
            'ei_cm': {f'q_{q:g}': mean_of(value, 100.0) for q, value in eis.items()},
            'ei_of_q_7': {f'q_{q:g}': ratio_of(value, eis[7.0]) for q, value in eis.items() if q != 7.0},
            'best_q': min(eis, key=lambda q: float(eis[q].mean())),
        }
    return result


def fusion_rules(runs: int = 1000, seed: int = 1, sought_runs: int = 200) -> Result:
    """Error indicator on a_circle of three random-q filters, and what each fusion rule changes (table 1).

    In percent of the local one, run by run over the same readings; negative is better.
    """
    circle = Circle(runs, seed)
    result: Result = {'runs': runs, 'seed': seed, 'runs_of_optimal_and_ici': sought_runs}
    for r in ('measured', 'predicted'):
        seven, table = circle.fixed(7.0, r), dict[str, Any]()
        for interval in INTERVALS:
            tracks = circle.drawn(interval, r)
            local = circle.local(tracks)
            changes = {rule: change_of(circle.fused(tracks, rule), local) for rule in RULES}
            if r == 'measured':
                for rule in SOUGHT:
                    changes[rule] = change_of(circle.fused(tracks, rule, sought_runs), local[:sought_runs])
            table['q_{:g}_to_{:g}'.format(*interval)] = {
                'local_ei_cm': mean_of(local, 100.0),
                'change_percent': changes,
                'local_change_percent_from_fixed_7': change_of(local, seven),
            }
        result[f'ckf_{r}'] = table
    return result
