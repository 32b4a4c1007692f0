"""The long runs of the real graph: `python -m wsn_tracking.studies.live -o docs/results`.

Parity: a replay gives what the evaluator computes, bit for bit, at every rate, repeated. Soak: a radio field at 20 Hz
for a minute, with the timeouts of a live network. Consensus: how long 50 nodes of system B take to agree, T = 1 s, and
whether they agree on what the evaluator computes. Targets: twenty of them on one node. Rejoin: how soon an estimator
that was killed takes part again.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wsn_tracking import graphs, processes
from wsn_tracking.bags.estimates import differences, read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.offline import offline
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.live_consensus import consensus
from wsn_tracking.studies.live_graph import alone, quietly
from wsn_tracking.studies.live_rejoin import rejoin
from wsn_tracking.studies.results import Result, Studies, call

REPEATS = 20
RATES = ((1.0, 10), (20.0, 120), (0.0, 120))  # rate (0: as fast as it goes), epochs
SOAK_HZ, SOAK_S = 20.0, 60.0
TARGETS = 20
PATIENCE_S = 120.0  # beyond what a run lasts


def parity(repeats: int = REPEATS) -> Result:
    """Replays at every rate against the evaluator: how many estimates differ in any bit."""
    rows = []
    for rate, epochs in RATES:
        with tempfile.TemporaryDirectory() as folder:
            bag = Path(folder, 'bag')
            save(bag, record(_first(scenario('a_loop'), epochs), 1))
            run = offline(*graphs.open_bag(str(bag)))
            differing, compared = 0, 0
            for repeat in range(repeats):
                published = _replayed(bag, rate, Path(folder, f'out_{repeat}'))
                for name, estimates in published.items():
                    compared += len(estimates)
                    differing += len(differences(estimates, run.estimates[name]))
        rows.append(
            {'rate': rate or 'max', 'epochs': epochs, 'repeats': repeats, 'compared': compared, 'differing': differing}
        )
    return {'rows': rows}


def soak() -> Result:
    """12 sensing nodes at 20 Hz, every measurement sent, 3 estimators, 60 s, live timeouts."""
    epochs = round(SOAK_HZ * SOAK_S)
    loop = scenario('a_loop')
    fast = loop._replace(period=1.0 / SOAK_HZ, truth=np.resize(loop.truth, (epochs, 4)))
    live = {'lossless': False, 'loss_timeout': 1.0, 'fusion_timeout': 0.2, 'trigger.kind': 'always'}
    with tempfile.TemporaryDirectory() as folder:
        bag, scores = Path(folder, 'bag'), Path(folder, 'scores.json')
        save(bag, record(fast, 1))
        recorder = {'output': str(Path(folder, 'out')), 'extra_topics': [f'estimate/fused_{i}' for i in (1, 2, 3)]}
        graph = graphs.replay(
            str(bag), rate=1.0, settings=live, evaluator={'json': str(scores), 'skip': 0.0}, record=recorder
        )
        begun = time.monotonic()
        code = quietly(graph, ['evaluator', 'bag_recorder'])
        took = time.monotonic() - begun
        fused = [e for estimates in read_estimates(Path(folder, 'out')).values() for e in estimates]
        told = json.loads(scores.read_text('utf-8'))
    return {
        'epochs': epochs,
        'ranges': told['measurements']['sent'],
        'estimates': {name: output['epochs'] for name, output in told['outputs'].items()},
        'dropped': told['input'],
        'degraded': sum(len(e.contributors) < 3 for e in fused),
        'exit_code': code,
        'behind_s': round(max(took - SOAK_S, 0.0), 0),  # start and end of nine processes included
    }


def targets(count: int = TARGETS, hertz: float = SOAK_HZ, seconds: float = SOAK_S) -> Result:
    """20 targets at 20 Hz each on one hybrid_tracker_node: the share of a core that it takes, its start included.

    Other load on the machine makes it more: `load` is what it was (processes that want to run, at begin and end).
    """
    field = scenario('d_phase', {'period': 1.0 / hertz, 'lasts': seconds})
    walks = (field.truth, *field.companions)
    field = field._replace(companions=tuple(walks[i % len(walks)] for i in range(1, count)))
    before = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        bag, scores = Path(folder, 'bag'), Path(folder, 'scores.json')
        save(bag, record(field, 1))
        graph = graphs.replay(str(bag), rate=1.0, trackers='hybrid', evaluator={'json': str(scores), 'skip': 2.0})
        with processes.started(graph, Path(folder)) as running:
            code = running['evaluator'].wait(seconds + PATIENCE_S)
            busy = processes.cpu_seconds(running['hybrid_tracker'].pid)
        told = json.loads(scores.read_text('utf-8'))
    outputs = told['outputs'].values()
    return {
        'targets': len(outputs),
        'hertz': hertz,
        'seconds': seconds,
        'share_of_a_core': round(busy / seconds, 3),
        'worst_rmse_m': round(max(output['rmse_m'] for output in outputs), 3),
        'dropped': told['input'],
        'exit_code': code,
        'load': [round(before, 1), round(os.getloadavg()[0], 1)],
    }


def _first(whole: Scenario, epochs: int) -> Scenario:
    return whole._replace(truth=whole.truth[:epochs])


def _replayed(bag: Path, rate: float, out: Path) -> dict[str, Any]:
    source, recording = graphs.open_bag(str(bag))
    outputs = graphs.plans_of(source, recording.anchors)[0].outputs
    recorder = {'output': str(out), 'extra_topics': [f'estimate/{output}' for output in outputs]}
    quietly(graphs.replay(str(bag), rate=rate, record=recorder), ['evaluator', 'bag_recorder'])
    return read_estimates(out)


STUDIES: Studies = {
    'live': {'parity': parity, 'soak': soak, 'consensus': consensus, 'targets': targets, 'rejoin': rejoin}
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    alone()
    return call('wsn_tracking.studies.live', 'Run the long runs of the real graph.', STUDIES, arguments)


if __name__ == '__main__':
    sys.exit(main())
