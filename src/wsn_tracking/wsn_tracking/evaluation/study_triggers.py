"""Triggers and estimators of system A at the same data rate, on its three scenarios."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.evaluation import monte_carlo as mc
from wsn_tracking.evaluation.intervals import mean_of, ratio_of
from wsn_tracking.evaluation.metrics import ei
from wsn_tracking.evaluation.study_process_noise import ESTIMATORS, identity_noise
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing import trigger
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.trackers.random_q_config import NoiseConfig, RandomQConfig, UpdateConfig

Result = dict[str, Any]
NEAR = {'a_loop': -46.9, 'a_circle': -44.5, 'a_heading': -47.8}  # [dBm] where `near` sends as much as `event`
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


def worlds(name: str, runs: int, paths: int) -> list[tuple[Scenario, Floats]]:
    """Scenarios with their walks (runs, K, 4); of a walk that is drawn, `paths` of them share the runs."""
    if name != 'a_heading':
        return [(s := scenario(name), mc.repeated(s, runs))]
    drawn = [scenario(name, seed=path) for path in range(1, paths + 1)]
    return [(s, mc.repeated(s, runs // paths)) for s in drawn]


def triggers_of(s: Scenario, share: float) -> dict[str, trigger.Trigger]:
    """The document's trigger, `near` at the same data rate, a random `share` of all signals as the control, all of them."""
    return {
        'event': trigger.event(trigger.EventThresholds(alpha=s.alpha)),
        'near': trigger.near(NEAR[s.name]),
        'random': trigger.random(share),
        'always': trigger.always(),
    }


def compare(s: Scenario, states: Floats, step: trigger.Trigger, seed: int) -> Compared:
    """Both estimators over what a trigger sends; equal seeds have equal noise, starts and draws."""
    generator = np.random.default_rng(seed)
    sensed = mc.sense(s, states, step, generator)
    start = mc.start_near(states, generator)
    uniform = generator.random((len(states), ESTIMATORS, states.shape[1]))
    fused = mc.fuse(mc.track(s, sensed, start, DOCUMENT, uniform), 'trace')
    one = mc.track(s, sensed, start, IPLF)
    return Compared(
        np.sum(~np.isnan(sensed.z), axis=(1, 2)).astype(np.float64),
        ei(mc.errors(fused, sensed))[:, 0],
        ei(mc.errors(one, sensed))[:, 0],
    )


def same_data_rate(name: str, runs: int, seed: int, paths: int = 4, kinds: tuple[str, ...] = ()) -> dict[str, Compared]:
    """Triggers on a scenario (all, or `kinds`); where paths are drawn, means over each path's runs, since those depend."""
    done: dict[str, list[Compared]] = {}
    for number, (s, states) in enumerate(worlds(name, runs, paths)):
        share = 0.0
        for kind in kinds or ('event', 'near', 'random', 'always'):
            step = triggers_of(s, share)[kind]
            compared = compare(s, states, step, seed + number)
            if kind == 'event':
                share = float(compared.sent.mean()) / (states.shape[1] * s.anchors.ids.size)
            done.setdefault(kind, []).append(compared)
    if name == 'a_heading':
        done = {kind: [Compared(*(np.mean(v, keepdims=True) for v in c)) for c in all_] for kind, all_ in done.items()}
    return {kind: Compared(*(np.concatenate(v) for v in zip(*all_, strict=True))) for kind, all_ in done.items()}


def data_rate(runs: int = 1000, seed: int = 1, paths: int = 40) -> Result:
    """Trigger `near` with one iterated filter against the document's system at the same data rate.

    a_heading: `paths` walks share the runs, and a path counts once.
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
                    'sent_of_event': float(f'{c.sent.mean() / event.sent.mean():.5g}'),
                    'ei_cm_document': mean_of(c.document, 100.0),
                    'ei_cm_iplf': mean_of(c.iplf, 100.0),
                }
                for kind, c in by_kind.items()
            },
        }
    return result
