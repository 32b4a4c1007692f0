"""System D on ranges of real radios and cameras (docs/datasets.md, docs/hybrid.md).

    python -m wsn_tracking.studies.real_radio.hybrid DATA -o docs/results

DATA holds the recordings, each in a folder of its own.
"""

from __future__ import annotations

import functools
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wsn_tracking import graphs
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.evaluation.intermittent import FOUND_WITHIN_S, at_instants, found_again, heard_of
from wsn_tracking.evaluation.run import summarise
from wsn_tracking.offline import offline
from wsn_tracking.parameters import Values
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.studies.intervals import known
from wsn_tracking.studies.real_radio.command import call
from wsn_tracking.studies.real_radio.sets import MRCLAM, Bags, Sets, find
from wsn_tracking.studies.results import Result, make

COMMAND = 'python -m wsn_tracking.studies.real_radio.hybrid DATA -o docs/results'


def of_labyrinth(bags: Bags, configuration: str = 'hybrid_labyrinth') -> Result:
    """UWB through walls, scored after the first 10 s (a third), from which the radios are calibrated."""
    calibrated = {'channel': bags.channel}
    rows: Mapping[str, Values] = {
        'uncalibrated': {},
        'calibrated': calibrated,
        'gaussian': {**calibrated, 'robust.dof': 0.0},
        'two_models': {**calibrated, 'form': 'imm', 'models.spectral_density': 0.05},
    }
    source, recording = bags.opened[0]
    result: Result = {'scored_from_s': bags.skip_s}
    for name, settings in rows.items():
        run = offline(source, recording, configuration, settings)
        (score,) = summarise(name, recording, run, bags.skip_s).outputs.values()
        result[name] = {'rmse_m': known(score.rmse_m), 'median_m': known(score.median_m), 'nees': known(score.nees)}
    return result


def of_robots(source: graphs.Source, recording: Recording, configuration: str = 'hybrid_mrclam') -> Result:
    """Five robots, ranges alone: median errors at 10 Hz instants with a range in the last 2 s, and how they are found.

    All robots are tracked at once, as the graph does. `found`: the median, over the times that a robot could be found
    (ranges to 3 landmarks within 8 s), of its error up to 10 s later.
    """
    estimates = offline(source, recording, configuration).estimates
    robots: dict[str, Result] = {}
    for target, truth in sorted(recording.truth.items()):
        heard = heard_of(recording, target)
        instants = at_instants(estimates[f'hybrid_target_{target}'], truth, heard)
        found = found_again(instants, heard)
        robots[str(target)] = {
            'median_m': known(instants.median_m),
            'instants': int(instants.counts.sum()),
            'found_median_m': known(found.median_after(FOUND_WITHIN_S)),
            'times_found': len(found.stamps_ns),
        }
    medians = [robot['median_m'] for robot in robots.values()]
    return {'robots': robots, 'mean_of_medians_m': known(float(np.mean(medians))), 'worst_median_m': max(medians)}


def open_robots(data: Path, work: Path) -> tuple[graphs.Source, Recording]:
    """The set of five robots below a folder, imported."""
    (bag,) = import_set(MRCLAM.kind, find(data, MRCLAM), work / 'mrclam')
    return graphs.open_bag(str(bag))


def run(data: Path, folder: Path, wanted: Sequence[str] = ()) -> Path:
    """Make the wanted tables (none: both) and write hybrid_real.json."""
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as work:
        tables = {
            'labyrinth': _named(of_labyrinth, lambda: of_labyrinth(Sets(data, Path(work)).bags('labyrinth'))),
            'mrclam': _named(of_robots, lambda: of_robots(*open_robots(data, Path(work)))),
        }
        (path,) = make(folder, wanted, {'hybrid_real': tables}, command=COMMAND)
    return path


def _named(like: Any, table: Any) -> Any:
    return functools.wraps(like)(table)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    return call('real_radio.hybrid', 'System D on recordings.', ('labyrinth', 'mrclam'), run, arguments)


if __name__ == '__main__':
    sys.exit(main())
