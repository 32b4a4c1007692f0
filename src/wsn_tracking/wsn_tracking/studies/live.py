"""The long runs of the real graph: `python -m wsn_tracking.studies.live -o docs/results`.

Parity: a replay gives what the evaluator computes, bit for bit, at every rate, repeated. Soak: a radio field at 20 Hz
for a minute, with the timeouts of a live network. Consensus: how long 50 nodes of system B take to agree, T = 1 s, and
whether they agree on what the evaluator computes. Targets: twenty of them on one node. Each graph runs alone in its
ROS domain: set ROS_DOMAIN_ID where others are about.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
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
from wsn_tracking.processes import run_graph
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.results import Result, Studies, call
from wsn_tracking.trackers.estimate import Estimate

REPEATS = 20
RATES = ((1.0, 10), (20.0, 120), (0.0, 120))  # rate (0: as fast as it goes), epochs
SOAK_HZ, SOAK_S = 20.0, 60.0
TARGETS = 20
PATIENCE_S = 120.0  # beyond what a run lasts
QUANTILES = {'median': 0.5, 'q95': 0.95, 'longest': 1.0}
SCHEMES = (('flood', 5), ('icf', 20))  # of system B, and their rounds
FIRST = 2  # epoch from which on time is taken: all code has been read from disk by then
IN_TIME_S = 0.8  # [s] that an epoch may take


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
        code = _quietly(graph, ['evaluator', 'bag_recorder'])
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


def consensus(bag: str = 'bags/b_field') -> Result:
    """50 nodes in four processes, T = 1 s, live timeouts: from a request to the last estimate, and what differs.

    Other load on the machine counts as well: `load` is what it was (processes that want to run, at begin and end).
    """
    source, recording = graphs.open_bag(bag)
    return {'cores': os.cpu_count(), 'rows': [_agreement(bag, source, recording, *scheme) for scheme in SCHEMES]}


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


def _agreement(bag: str, source: graphs.Source, recording: Recording, scheme: str, rounds: int) -> Result:
    settings = {'scheme': scheme, 'rounds': rounds}
    run = offline(source, recording, settings=settings)
    ids = recording.anchors.ids.tolist()
    live = {'lossless': False, 'loss_timeout': 0.5, 'round_timeout': 0.0}  # 0: as it is by default, not as in replay
    before = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        recorder = {'output': str(Path(folder, 'out')), 'extra_topics': [f'estimate/consensus_{i}' for i in ids]}
        words = [sys.executable, '-m', 'wsn_tracking.nodes.consensus_timing', *map(str, [run.epochs, *ids])]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as timing:
            _quietly(
                graphs.replay(bag, rate=1.0, settings={**settings, **live}, record=recorder),
                ['evaluator', 'bag_recorder'],
            )
            try:
                said, _ = timing.communicate(timeout=10.0)
            except subprocess.TimeoutExpired:  # some estimate has never come
                timing.kill()
                said = '[]'
        published = read_estimates(Path(folder, 'out'))
    took = np.array(json.loads(said)[FIRST:])
    return {
        'scheme': scheme,
        'rounds': rounds,
        'epochs': took.size,
        'over': int(np.sum(took > IN_TIME_S)),
        **{f'{name}_s': round(float(np.quantile(took, q)), 3) for name, q in QUANTILES.items() if took.size},
        'compared': sum(map(len, run.estimates.values())),
        'differing': sum(_differing(published.get(name, ()), all_) for name, all_ in run.estimates.items()),
        'load': [round(before, 1), round(os.getloadavg()[0], 1)],
    }


def _differing(published: Sequence[Estimate], computed: Sequence[Estimate]) -> int:
    """Estimates that never came, or differ by more than 1e-9."""
    there = {e.request_seq: e for e in published}
    return sum(
        seen is None
        or not np.allclose(seen.mean, e.mean, rtol=0.0, atol=1e-9)
        or not np.allclose(seen.covariance, e.covariance, rtol=0.0, atol=1e-9)
        for e, seen in ((e, there.get(e.request_seq)) for e in computed)
    )


def _first(whole: Scenario, epochs: int) -> Scenario:
    return whole._replace(truth=whole.truth[:epochs])


def _replayed(bag: Path, rate: float, out: Path) -> dict[str, Any]:
    source, recording = graphs.open_bag(str(bag))
    outputs = graphs.plans_of(source, recording.anchors)[0].outputs
    recorder = {'output': str(out), 'extra_topics': [f'estimate/{output}' for output in outputs]}
    _quietly(graphs.replay(str(bag), rate=rate, record=recorder), ['evaluator', 'bag_recorder'])
    return read_estimates(out)


def _quietly(graph: tuple[graphs.Process, ...], last: list[str]) -> int:
    with contextlib.redirect_stderr(io.StringIO()):
        return run_graph(graph, last)


STUDIES: Studies = {'live': {'parity': parity, 'soak': soak, 'consensus': consensus, 'targets': targets}}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status. Each graph is this host's alone."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    return call('wsn_tracking.studies.live', 'Run the long runs of the real graph.', STUDIES, arguments)


if __name__ == '__main__':
    sys.exit(main())
