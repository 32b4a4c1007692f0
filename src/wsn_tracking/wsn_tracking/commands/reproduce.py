"""`wsn-tracking reproduce`."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from wsn_tracking.commands.base import Commands, add_command, progress, seed
from wsn_tracking.errors import TrackingError
from wsn_tracking.files import check_folder

BACKENDS = ('loky', 'threading', 'dask')
SEED = 7001  # no test uses it


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'reproduce',
        _do,
        'compute the claims of the five documents anew, and write a report',
        '',
        '--quick',
        'A B2 -o two',
        'C --backend dask --scheduler tcp://10.0.0.1:8786',
    )
    told = 'documents A to E, the comparison X, or claims (A3); default: all'
    command.add_argument('names', nargs='*', metavar='CLAIM', help=told)
    command.add_argument('--quick', action='store_true', help='fewer runs, the same verdicts')
    command.add_argument('-o', '--output', type=Path, default=Path('reproduction'), metavar='DIR', help='of the report')
    command.add_argument(
        '--data', type=Path, metavar='DIR', help='recordings of docs/datasets.md, a folder each: compared on, too'
    )
    command.add_argument('--seed', type=seed, default=SEED, help=f'of all draws (default: {SEED})')
    command.add_argument('--jobs', type=_jobs, default=0, metavar='N', help='workers (default: one a core)')
    command.add_argument('--backend', choices=BACKENDS, default='loky', help='of joblib: processes, threads, or Dask')
    command.add_argument('--scheduler', default='', metavar='ADDRESS', help='dask: default: a cluster on this machine')


def _jobs(text: str) -> int:
    """A number of workers."""
    if not text.isdecimal() or not 1 <= int(text) <= 4096:
        raise argparse.ArgumentTypeError(f'{text!r} is no number of workers: expected 1 or more')
    return int(text)


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.evaluation.plot_style import new_figure
    from wsn_tracking.reproduction.catalogue import wanted
    from wsn_tracking.reproduction.content import Setting, commit
    from wsn_tracking.reproduction.engine import Workers
    from wsn_tracking.reproduction.reproduce import COMPARISON, computed, write

    claims = wanted(options.names)
    if options.data and not any(claim.document == COMPARISON for claim in claims):
        raise TrackingError('--data is for the comparison of all systems: add X to what is computed')
    check_folder(options.output)
    new_figure(1.0, 1.0)  # what cannot be drawn or written is told before the work
    given = [*(['--quick'] if options.quick else []), *(['--data', 'DATA'] if options.data else [])]
    words = [*(name.upper() for name in options.names), *given, '--seed', str(options.seed)]
    setting = Setting(options.seed, options.quick, f'./wsn-tracking reproduce {shlex.join(words)}', commit())
    workers = Workers(options.jobs, options.backend, options.scheduler)
    found = computed(claims, setting, workers, progress('reproduce'), options.data)
    for claim in found['claims']:
        print(f'{claim["id"]:4} {found["verdicts"][claim["id"]]:17} {claim["place"]}')
    for path in write(options.output, found):
        print(path)
    return 0
