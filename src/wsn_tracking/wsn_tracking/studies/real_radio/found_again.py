"""What it is worth to find a track anew, by itself: after a silence, and from a place where the target is not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping

import numpy as np

from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.evaluation.run import epochs_of
from wsn_tracking.graphs.parts import Source
from wsn_tracking.graphs.plans import plans_of
from wsn_tracking.graphs.random_q import RandomQPlan
from wsn_tracking.models.anchors import Floats
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Epoch
from wsn_tracking.studies.real_radio.sets import Bags, Sets
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.estimator import make_estimator

GAP_S = 20.0  # in which nothing is heard
EVERY_S = 45.0  # from gap to gap
AFTER_S = 10.0  # for which errors are looked at, from the end of a gap
WRONG_S = (5.0, 30.0)  # after a wrong start, likewise
SILENCE: Mapping[str, Values] = {
    'goes_on': {'reacquire.odds': 0.0},
    'found_anew': {'reacquire.odds': 0.0, 'reacquire.silence': 5.0},
    'odds': {},
}
GATED = {'robust.gate': 3.0}
WRONG: Mapping[str, Values] = {
    'goes_on': {'reacquire.odds': 0.0},
    'gate_alone': {**GATED, 'reacquire.odds': 0.0},
    'gate_and_rejects': {**GATED, 'reacquire.rejects': 8, 'reacquire.odds': 0.0},
    'odds': {},
}


def danis_found_again(sets: Sets) -> Result:
    """BLE beacon in a flat, one estimator of all receivers as `danis_central` has it; pooled over the four tracks."""
    bags = sets.bags('danis')
    return {
        'silences': {name: after_gaps(bags, 'danis_central', settings) for name, settings in SILENCE.items()},
        'wrong_start': {name: from_wrong_start(bags, 'danis_central', settings) for name, settings in WRONG.items()},
        'gap_s': GAP_S,
        'scored_after_a_gap_s': AFTER_S,
        'scored_after_a_wrong_start_s': list(WRONG_S),
    }


def after_gaps(bags: Bags, configuration: str, settings: Values) -> Result:
    """Errors after each gap."""
    errors = []
    for source, recording in bags.opened:
        times, away = _errors(source, recording, configuration, settings, _in_gap)
        since = times % EVERY_S
        errors.append(away[(times > EVERY_S) & (since < AFTER_S)])
    return _told(errors)


def from_wrong_start(bags: Bags, configuration: str, settings: Values) -> Result:
    """Every track begins in the corner of the area that is furthest from the target, sure of it to 0.5 m."""
    errors = []
    for source, recording in bags.opened:
        first = next(iter(recording.truth.values())).positions[0, :2]
        x0, y0, x1, y1 = source.area
        corner = [x1 if first[0] < 0.5 * (x0 + x1) else x0, y1 if first[1] < 0.5 * (y0 + y1) else y0]
        start = {'start.kind': 'given', 'start.mean': [*corner, 0.0, 0.0], 'start.std': [0.5, 0.5, 0.7, 0.7]}
        times, away = _errors(source, recording, configuration, {**settings, **start})
        errors.append(away[(times >= WRONG_S[0]) & (times < WRONG_S[1])])
    return _told(errors)


def _in_gap(seconds: float) -> bool:
    """Whether nothing is heard at that time after the start: for GAP_S before every multiple of EVERY_S."""
    return seconds > EVERY_S - GAP_S and seconds % EVERY_S >= EVERY_S - GAP_S


def _never(_seconds: float) -> bool:
    return False


def _errors(
    source: Source, recording: Recording, configuration: str, settings: Values, silent: Callable[[float], bool] = _never
) -> tuple[Floats, Floats]:
    """Seconds since the start, and distance from the truth [m], of every epoch; in silence nothing is heard."""
    (plan,) = plans_of(source, recording.anchors, 'random_q', configuration, {**settings, 'peers': [1]})
    assert isinstance(plan, RandomQPlan)  # what was asked for
    local, _ = make_estimator(build(EstimatorNodeConfig, plan.estimators[0]), recording.anchors)
    epochs: Iterable[Epoch] = epochs_of(recording, plan.target_id, Counter())
    stamps, places = [], []
    for epoch in epochs:
        stamps.append(epoch.stamp_ns)
        seconds = (epoch.stamp_ns - stamps[0]) * 1e-9
        heard = epoch._replace(measurements=()) if silent(seconds) else epoch
        places.append(local.step(heard).mean[:2])
    real = truth_at(recording.truth[plan.target_id], np.array(stamps)).positions
    return (np.array(stamps) - stamps[0]) * 1e-9, np.hypot(*(np.array(places) - real[:, :2]).T)


def _told(errors: list[Floats]) -> Result:
    every = np.concatenate(errors)
    every = every[np.isfinite(every)]
    return {
        'rmse_m': round(float(np.sqrt(np.mean(every**2))), 3),
        'median_m': round(float(np.median(every)), 3),
        'epochs': int(every.size),
    }


TABLES = {'danis_found_again': danis_found_again}
