"""Triggers and estimators of system A at the same data rate, on its three scenarios."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wsn_tracking.evaluation.metrics import ei
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.scenarios import BY_SEED, scenario
from wsn_tracking.studies import random_q_runs as runs_of
from wsn_tracking.studies.intervals import mean_of, ratio_of
from wsn_tracking.studies.random_q_noise import ESTIMATORS, identity_noise
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, UpdateConfig

Radio = Callable[[Scenario, runs_of.Sensed], runs_of.Sensed]  # what is sent -> what arrives
NEAR = {'a_loop': -46.9, 'a_circle': -44.5, 'a_heading': -47.8}  # [dBm] where `near` sends as much as `event`
KINDS = ('event', 'near', 'random', 'always')
DOCUMENT = identity_noise(6.0, 8.0)
IPLF = RandomQConfig(  # q_min = q_max: its noise is fixed
    noise=NoiseConfig(kind='acceleration', q_min=7.0, q_max=7.0, spectral_density=1.6e-3),
    update=UpdateConfig(kind='iplf'),
)


class Compared(NamedTuple):
    """One trigger, on every run."""

    sent: Floats  # (runs,) measurements
    document: Floats  # (runs,) EI [m] of three filters with q ~ U[6, 8], fused by CI
    iplf: Floats  # (runs,) EI [m] of one iterated filter with fixed white acceleration
    document_nees: Floats  # (runs,) of the 2-D position: 2 is consistent
    iplf_nees: Floats  # (runs,)


def world(name: str, runs: int, paths: int) -> tuple[Scenario, Floats]:
    """A scenario and its walk in every run (runs, K, 4); of walks that are drawn, `paths` share the runs."""
    if name not in BY_SEED:
        return (s := scenario(name)), runs_of.repeated(s, runs)
    drawn = [scenario(name, seed=path) for path in range(1, paths + 1)]
    return drawn[0], np.concatenate([runs_of.repeated(s, runs // paths) for s in drawn])


def triggers_of(s: Scenario, share: float) -> dict[str, trigger.Trigger]:
    """The document's trigger, `near` at the same data rate, a random `share` of all as the control, and all."""
    return {
        'event': trigger.event(trigger.EventThresholds(alpha=s.alpha)),
        'near': trigger.near(NEAR[s.name]),
        'random': trigger.random(share),
        'always': trigger.always(),
    }


def unchanged(s: Scenario, sensed: runs_of.Sensed) -> runs_of.Sensed:
    """A radio that tells what was measured."""
    return sensed


def compare(s: Scenario, states: Floats, step: trigger.Trigger, seed: int, radio: Radio = unchanged) -> Compared:
    """Both estimators over what a trigger sends; equal seeds have equal noise, starts and draws."""
    generator = np.random.default_rng(seed)
    sensed = radio(s, runs_of.sense(s, states, step, generator))
    start = runs_of.start_near(states, generator)
    uniform = generator.random((len(states), ESTIMATORS, states.shape[1]))
    fused = runs_of.fuse(runs_of.track(s, sensed, start, DOCUMENT, uniform), 'trace')
    one = runs_of.track(s, sensed, start, IPLF)
    return Compared(
        np.sum(~np.isnan(sensed.z), axis=(1, 2)).astype(np.float64),
        ei(runs_of.errors(fused, sensed))[:, 0],
        ei(runs_of.errors(one, sensed))[:, 0],
        runs_of.position_nees(fused, sensed).mean(axis=(1, 2)),
        runs_of.position_nees(one, sensed).mean(axis=(1, 2)),
    )


def same_data_rate(name: str, runs: int, seed: int, paths: int, kinds: tuple[str, ...] = KINDS) -> dict[str, Compared]:
    """Triggers on a scenario, run by run; where paths are drawn, path by path (the means of its runs)."""
    s, states = world(name, runs, paths)
    done: dict[str, Compared] = {}
    share = 0.0
    for kind in kinds:
        done[kind] = compare(s, states, triggers_of(s, share)[kind], seed)
        share = float(done['event'].sent.mean()) / (states.shape[1] * s.anchors.ids.size)
    if name in BY_SEED:
        done = {k: Compared(*(v.reshape(paths, -1).mean(axis=1) for v in c)) for k, c in done.items()}
    return done


def data_rate(runs: int = 1000, seed: int = 1, paths: int = 40) -> Result:
    """Trigger `near` with one iterated filter against the document's system at the same data rate.

    a_heading: `paths` walks share the runs, and each counts once.
    """
    result: Result = {'runs': runs, 'seed': seed, 'paths_of_a_heading': paths}
    for name, y_min in NEAR.items():
        by_kind = same_data_rate(name, runs, seed, paths)
        event = by_kind['event']
        result[name] = {
            'near_y_min_dbm': y_min,
            'near_iplf_of_event_document': ratio_of(by_kind['near'].iplf, event.document),
            'triggers': {
                kind: {
                    'sent_a_run': mean_of(c.sent),
                    'sent_of_event': ratio_of(c.sent, event.sent),
                    'ei_cm_document': mean_of(c.document, 100.0),
                    'ei_cm_iplf': mean_of(c.iplf, 100.0),
                }
                for kind, c in by_kind.items()
            },
        }
    return result
