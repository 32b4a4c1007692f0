"""System B on MRCLAM (docs/datasets.md): landmarks are nodes, each robot a run, judged at regular instants.

    python -m wsn_tracking.studies.real_radio.mrclam DATA -o docs/results

DATA holds the recordings, each in a folder of its own. Every node is judged; the figures are of the worst.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.epochs import with_epoch_ends
from wsn_tracking.bags.importing import mrclam as importing
from wsn_tracking.evaluation.intermittent import FOUND_WITHIN_S, at_instants, found_again, heard_of
from wsn_tracking.evaluation.run import Run
from wsn_tracking.graphs.consensus import ConsensusPlan
from wsn_tracking.models.graph import adjacency, diameter, is_connected
from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.offline import offline
from wsn_tracking.parameters import build
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.studies.real_radio.command import call
from wsn_tracking.studies.real_radio.sets import MRCLAM, find
from wsn_tracking.studies.results import make

COMMAND = 'python -m wsn_tracking.studies.real_radio.mrclam DATA -o docs/results'
CONFIGURATION = 'consensus_mrclam'


def open_mrclam(data: Path) -> tuple[graphs.Source, Recording]:
    """The set below a folder, as its bag would be."""
    recording = with_epoch_ends(importing.load(find(data, MRCLAM)))
    return graphs.source_of(MRCLAM.kind, recording), recording


def judge(run: Run, recording: Recording, target_id: int) -> dict[str, float]:
    """Median error, and the median of those 10 s after a robot could be found, of the worst node [m]."""
    heard, truth = heard_of(recording, target_id), recording.truth[target_id]
    medians, found = [], []
    for estimates in run.estimates.values():
        instants = at_instants(estimates, truth, heard)
        medians.append(instants.median_m)
        found.append(found_again(instants, heard).median_after(FOUND_WITHIN_S))
    return {'median_m': max(medians), 'found_median_m': max(found), 'best_median_m': min(medians)}


def robots(source: graphs.Source, recording: Recording) -> dict[str, Any]:
    """Every robot: median errors at 10 Hz instants with a range in the last 2 s, and 10 s after it could be found."""
    (plan,) = graphs.plans_of(source, recording.anchors, configuration=CONFIGURATION)
    assert isinstance(plan, ConsensusPlan)  # of a configuration of system B
    config = build(ConsensusNodeConfig, plan.values)
    graph = adjacency(recording.anchors.positions, config.radius)
    rows = {
        str(robot): judge(offline(source, recording, CONFIGURATION, target_id=robot), recording, robot)
        for robot in sorted(recording.truth)
    }
    return {
        'robots': rows,
        'mean_of_medians_m': float(np.mean([row['median_m'] for row in rows.values()])),
        'graph': {
            'radius_m': config.radius,
            'connected': bool(is_connected(graph)),
            'diameter': int(diameter(graph)),
            'neighbours': float(graph.sum(axis=-1).mean()),
        },
    }


def run(data: Path, folder: Path, wanted: Sequence[str] = ()) -> Path:
    """Make the table and write consensus_mrclam.json."""
    table = functools.wraps(robots)(functools.partial(robots, *open_mrclam(data)))
    (path,) = make(folder, wanted, {'consensus_mrclam': {'robots': table}}, command=COMMAND)
    return path


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    return call('real_radio.mrclam', 'System B on MRCLAM.', ('robots',), run, arguments)


if __name__ == '__main__':
    sys.exit(main())
