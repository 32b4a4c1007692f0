"""Two robots in phase as a picture: their tracks, and how far the second one is behind.

python -m wsn_tracking.studies.phase_plot -o phase.png [--seed N]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.plot_style import COLOURS, INK, MUTED, dress, heading, new_figure, save
from wsn_tracking.simulation.d_cells import CellsConfig, nodes
from wsn_tracking.studies.phase_runs import PhaseConfig, PhaseRun, run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = ('first', 'second')


def phase_figure(r: PhaseRun, title: str) -> Figure:
    """Tracks on the left; on the right the angular speeds, and the error in phase below."""
    figure = new_figure(10.0, 5.0)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.5))
    tracks = figure.add_subplot(grid[:, 0])
    anchors = nodes().positions
    tracks.plot(anchors[:, 0], anchors[:, 1], '^', color=MUTED, markersize=5, label='nodes')
    for i, name in enumerate(NAMES):
        tracks.plot(*r.truth[i, :, :2].T, color=INK, linewidth=1.0, label='truth' if i == 0 else None)
        tracks.plot(*r.estimates[i].T, color=COLOURS[i], linewidth=0.8, label=f'{name}, estimated')
    tracks.set_aspect('equal')
    tracks.set(xlabel='x [m]', ylabel='y [m]')
    tracks.legend(loc='upper right', fontsize=7, frameon=False)
    speeds = figure.add_subplot(grid[0, 1])
    for i, name in enumerate(NAMES):
        speeds.plot(r.times, angular_speed(r, i), color=COLOURS[i], linewidth=1.0, label=name)
    speeds.set(ylabel='angular speed [rad/s]')
    speeds.legend(loc='lower right', fontsize=7, frameon=False)
    error = figure.add_subplot(grid[1, 1], sharex=speeds)
    error.axhline(0.0, color=MUTED, linewidth=0.6)
    error.plot(r.times, np.degrees(r.error), color=COLOURS[1], linewidth=1.0)
    error.set(xlabel='time [s]', ylabel='second behind first [deg]')
    for axes in (tracks, speeds, error):
        dress(axes)
    heading(figure, title, 1, 1)
    return figure


def angular_speed(r: PhaseRun, robot: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Of a robot's velocity (K,) [rad/s]: how fast it turns about the middle of its circle."""
    config = PhaseConfig().follow
    centre = np.array(config.first_centre if robot == 0 else config.centre)
    away, v = r.truth[robot, :, :2] - centre, r.truth[robot, :, 2:]
    cross = away[:, 0] * v[:, 1] - away[:, 1] * v[:, 0]
    return np.asarray(cross / np.sum(away**2, axis=-1), dtype=np.float64)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    parser = argparse.ArgumentParser(prog='wsn_tracking.studies.phase_plot', description=__doc__.split('\n')[0])
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='FILE', help='PNG to write')
    parser.add_argument('--seed', type=int, default=1, help='of ranges and losses (default: 1)')
    parser.add_argument('--lasts', type=float, default=60.0, metavar='S', help='of the run (default: 60)')
    options = parser.parse_args(arguments)
    try:
        found = run(PhaseConfig(cells=CellsConfig(lasts=options.lasts)), options.seed)
        save(phase_figure(found, 'Two robots in phase by feedback over the network'), options.output)
    except TrackingError as error:
        print(f'phase_plot: {error}', file=sys.stderr)
        return 1
    print(options.output)
    return 0


if __name__ == '__main__':
    sys.exit(main())
