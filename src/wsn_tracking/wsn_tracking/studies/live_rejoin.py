"""An estimator that is killed in mid-run and started anew: how soon it takes part again."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from wsn_tracking import graphs, processes
from wsn_tracking.bags.estimates import read_estimates
from wsn_tracking.bags.read import raw_messages
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.results import Result

REPEATS = 10
EPOCHS = 24  # one a second
RUNS_S, GONE_S = 10.0, 5.0  # start included; long enough that nobody waits for it any more
PATIENCE_S = 120.0
TIMEOUTS = {'live': {'lossless': False, 'loss_timeout': 1.0, 'fusion_timeout': 0.2}, 'replay': {}}
WATCHED = 'fused_1'
KILLED = 2


def rejoin(repeats: int = REPEATS) -> Result:
    """Estimator 2 of three killed and started anew, T = 1 s: from its start until its estimates are fused again."""
    rows = []
    for timeouts, settings in TIMEOUTS.items():
        took = [_once(settings) for _ in range(repeats)]
        rows.append(
            {
                'timeouts': timeouts,
                'repeats': repeats,
                'median_s': round(float(np.median(took)), 2),
                'longest_s': round(max(took), 2),
            }
        )
    return {'rows': rows}


def _once(settings: Mapping[str, Any]) -> float:
    """From the start of the new process to the first fused estimate that it has a part in [s]."""
    with tempfile.TemporaryDirectory() as folder:
        return _timed(Path(folder), settings)


def _timed(folder: Path, settings: Mapping[str, Any]) -> float:
    loop = scenario('a_loop')
    bag, out = folder / 'bag', folder / 'out'
    save(bag, record(loop._replace(truth=loop.truth[:EPOCHS]), 1))
    recorder = {'output': str(out), 'extra_topics': [f'estimate/{WATCHED}']}
    graph = graphs.replay(str(bag), rate=1.0, settings=settings, record=recorder)
    with processes.started(graph, folder) as running:
        time.sleep(RUNS_S)
        running[f'estimator_{KILLED}'].kill()
        time.sleep(GONE_S)
        begun_ns = time.time_ns()
        with processes.started([p for p in graph if p.name == f'estimator_{KILLED}'], folder):
            running['bag_recorder'].wait(PATIENCE_S)
    logged = [raw.log_ns for raw in raw_messages(out) if raw.topic.strip('/') == f'estimate/{WATCHED}']
    has_part = [KILLED in estimate.contributors for estimate in read_estimates(out)[WATCHED]]
    told = list(zip(logged, has_part, strict=True))
    before = [part for at, part in told if at < begun_ns]
    if not before or before[-1]:
        raise TrackingError(
            f'estimator {KILLED} was not missed: {RUNS_S:g} s are too few on this machine, end other load'
        )
    return (next(at for at, part in told if at > begun_ns and part) - begun_ns) / 1e9
