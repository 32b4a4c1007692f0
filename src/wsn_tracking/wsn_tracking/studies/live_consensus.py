"""System B as processes: how soon its nodes agree, and whether on what the evaluator computes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.estimates import read_estimates
from wsn_tracking.offline import offline
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.studies.live_graph import quietly
from wsn_tracking.studies.results import Result
from wsn_tracking.trackers.estimate import Estimate

QUANTILES = {'median': 0.5, 'q95': 0.95, 'longest': 1.0}
SCHEMES = (('flood', 5), ('icf', 20))  # of system B, and their rounds
FIRST = 2  # epoch from which on time is taken: all code has been read from disk by then
IN_TIME_S = 0.8  # [s] that an epoch may take


def consensus(bag: str = 'bags/b_field') -> Result:
    """50 nodes in four processes, T = 1 s, live timeouts: from a request to the last estimate, and what differs.

    Other load on the machine counts as well: `load` is what it was (processes that want to run, at begin and end).
    """
    source, recording = graphs.open_bag(bag)
    return {'cores': os.cpu_count(), 'rows': [_agreement(bag, source, recording, *scheme) for scheme in SCHEMES]}


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
            quietly(
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
