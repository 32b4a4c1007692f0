"""Radios tell signal strengths in whole dB: what that does to the triggers and to the estimates of system A."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.radio import range_at, rssi_at
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.scenarios import BY_SEED
from wsn_tracking.studies import random_q_runs as runs_of
from wsn_tracking.studies.intervals import mean_of, ratio_of
from wsn_tracking.studies.random_q_triggers import NEAR, Radio, compare, unchanged, world
from wsn_tracking.studies.results import Result


def whole(y: Floats) -> Floats:
    """To the nearest whole dB, as a receiver's register has it."""
    return np.asarray(np.floor(y + 0.5))


def before(step: trigger.Trigger) -> trigger.Trigger:
    """A trigger that sees whole dB: one that runs behind the radio, on the host."""
    return lambda yhat, y, u: step(yhat, whole(y), u)


def told_in_whole_db(s: Scenario, sensed: runs_of.Sensed) -> runs_of.Sensed:
    """The ranges of rounded signal strengths."""
    return sensed._replace(z=range_at(s.anchors, whole(rssi_at(s.anchors, sensed.z))))


def whole_db(runs: int = 400, seed: int = 1, paths: int = 40) -> Result:
    """Signal strengths in whole dB: rounded before the trigger (on the host), behind it (on board), or not at all.

    Every way has the same noise, starts and draws. a_heading: `paths` walks share the runs, and each counts once.
    """
    result: Result = {'runs': runs, 'seed': seed, 'paths_of_a_heading': paths}
    for name, y_min in NEAR.items():
        s, states = world(name, runs, paths)
        event = trigger.event(trigger.EventThresholds(alpha=s.alpha))
        near = trigger.near(y_min)
        ways: dict[str, dict[str, tuple[trigger.Trigger, Radio]]] = {
            'event': {
                'exact': (event, unchanged),
                'behind': (event, told_in_whole_db),
                'before': (before(event), told_in_whole_db),
            },
            'near': {'exact': (near, unchanged), 'before': (before(near), told_in_whole_db)},
        }
        result[name] = {
            kind: _compared(s, states, by_way, seed, paths if name in BY_SEED else runs)
            for kind, by_way in ways.items()
        }
    return result


def _compared(
    s: Scenario, states: Floats, ways: dict[str, tuple[trigger.Trigger, Radio]], seed: int, independent: int
) -> Result:
    def each(values: Floats) -> Floats:
        return np.asarray(values.reshape(independent, -1).mean(axis=1))

    told = {}
    exact = None
    for way, (step, radio) in ways.items():
        compared = compare(s, states, step, seed, radio)
        heard = runs_of.in_radius(runs_of.sense(s, states, step, np.random.default_rng(seed))).sum(axis=(1, 2))
        exact = exact or compared
        told[way] = {
            'sent_a_run': mean_of(each(compared.sent)),
            'sent_of_in_radius': ratio_of(each(compared.sent), each(heard.astype(np.float64))),
            'ei_cm_document': mean_of(each(compared.document), 100.0),
            'ei_cm_iplf': mean_of(each(compared.iplf), 100.0),
            'document_of_exact': ratio_of(each(compared.document), each(exact.document)),
            'iplf_of_exact': ratio_of(each(compared.iplf), each(exact.iplf)),
        }
    return told
