"""Runs of system A over short recordings."""

from __future__ import annotations

import dataclasses

from graph_cases import a_loop

from wsn_tracking.evaluation.run_random_q import Sensing, run_random_q
from wsn_tracking.sensing.stage import TriggerConfig
from wsn_tracking.trackers.estimator import EstimatorConfig

TRIGGER = TriggerConfig(alpha=0.3)
NEAR = TriggerConfig(kind='near', y_min=-50.0)
SENSING = Sensing(NEAR, 0)
AREA = (0.0, 0.0, 3.6, 2.4)


def estimators(n=3, **options):
    """Estimators 1 to n that fuse each other."""
    base = EstimatorConfig(peers=tuple(range(1, n + 1)), input='range', area=AREA, **options)
    return [dataclasses.replace(base, id=number) for number in range(1, n + 1)]


def run(recording=None, sensing=SENSING, configs=None, target_id=-1):
    """What they make of a recording, twelve epochs of a_loop where nothing else is said."""
    return run_random_q(recording or a_loop(12), sensing, configs or estimators(), target_id)
