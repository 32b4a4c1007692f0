"""Two robots in phase, live (seed 001, its second experiment).

    python -m wsn_tracking.follower -o follower

A simulated sink, the serial bridge and the hybrid tracker run as processes; the second robot drives by the position
feedback that comes back through the sink. The folder gets the bag (truth, ranges, estimates) and phase.png.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from wsn_tracking import graphs
from wsn_tracking.configuration import parse_setting
from wsn_tracking.errors import TrackingError
from wsn_tracking.files import check_new_folder
from wsn_tracking.graphs.follower import SINK
from wsn_tracking.node_parameters.serial import SinkSimulatorConfig
from wsn_tracking.parameters import Values, build
from wsn_tracking.processes import run_graph
from wsn_tracking.studies.phase import summary
from wsn_tracking.studies.phase_recorded import phase_run
from wsn_tracking.studies.phase_runs import SETTLED_S
from wsn_tracking.studies.results import Result


def follow(output: Path, seed: int, settings: Values) -> Result:
    """Run the ring, draw what came of it; how well the second robot kept in phase once it had caught up."""
    from wsn_tracking.evaluation.plot_style import save
    from wsn_tracking.studies.phase_plot import phase_figure

    check_new_folder(output)
    bag = output / 'bag'
    config = build(SinkSimulatorConfig, settings).driven
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        processes = graphs.follower(str(Path(folder, 'sink')), seed=seed, settings=settings, record=str(bag))
        if code := run_graph(processes, [SINK]):
            raise TrackingError(f'the ring of sink, bridge and tracker ended with code {code}: see above')
    found = phase_run(bag, config.robot)
    save(phase_figure(found, 'Two robots in phase by feedback through the sink'), output / 'phase.png')
    return summary([found], min(SETTLED_S, 0.5 * config.cells.lasts))


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    parser = argparse.ArgumentParser(prog='wsn_tracking.follower', description=__doc__.split('\n')[0])
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder; it must not exist')
    parser.add_argument('--lasts', type=float, default=60.0, metavar='S', help='of the run (default: 60)')
    parser.add_argument('--seed', type=int, default=1, help='of the ranges and the radio (default: 1)')
    parser.add_argument(
        '--set', action='append', default=[], metavar='NAME=VALUE', help='set one parameter of any of the nodes'
    )
    options = parser.parse_args(arguments)
    try:
        settings = {'driven.cells.lasts': options.lasts, **dict(map(parse_setting, options.set))}
        for name, value in follow(options.output, options.seed, settings).items():
            print(f'{name:20}{value:g}')
    except TrackingError as error:
        print(f'follower: {error}', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())
