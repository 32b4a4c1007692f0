"""`wsn-tracking plot`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from wsn_tracking import graphs
from wsn_tracking.commands.base import Commands, add_bag, add_command, add_tracking, progress, settings
from wsn_tracking.evaluation.run import Run
from wsn_tracking.models.region import region_of
from wsn_tracking.sensing.recording import Recording


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'plot',
        _do,
        'run the trackers on a bag and draw map, errors and NEES as PNG',
        'bags/a_loop',
        'bags/a_loop -o plots --set trigger.kind=always',
    )
    add_bag(command)
    add_tracking(command, scores=False)
    command.add_argument('-o', '--output', default='plots', metavar='DIR', help='folder for the PNGs (default: plots)')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.offline import offline

    source, recording = graphs.open_bag(options.bag, options.namespace)
    run = offline(
        source,
        recording,
        options.config,
        settings(options),
        options.target,
        progress(source.title),
        options.trackers,
    )
    written = draw(Path(options.output), source, recording, run, options.skip)
    for path in written:
        print(path)
    if len(written) == 1:
        print(f'{options.bag}: no truth/target_<id> of what was tracked, so there is only the map', file=sys.stderr)
    return 0


def draw(folder: Path, source: graphs.Source, recording: Recording, run: Run, skip_s: float) -> list[Path]:
    """Draw a run into a folder: the paths of map.png and, where the truth is known, error.png and nees.png."""
    from wsn_tracking.evaluation.plots import plot_all

    area = source.area
    tracked = {estimates[0].target_id for estimates in run.estimates.values()}
    return plot_all(
        folder,
        recording.anchors,
        {target: truth for target, truth in recording.truth.items() if target in tracked},
        run.estimates,
        region_of(area).box if area else None,
        title=source.title,
        start_ns=run.start_ns,
        skip_s=skip_s,
    )
