"""`wsn-tracking bench`."""

from __future__ import annotations

import argparse
import sys

from wsn_tracking.commands.base import Commands, add_command

GROUPS = ('filter', 'fusion', 'consensus', 'particles', 'bags', 'serial', 'graph', 'nodes', 'people')


def add(commands: Commands) -> None:
    """Describe the command."""
    command = add_command(
        commands,
        'bench',
        _do,
        'measure the speed against goals and, where they are installed, other libraries',
        '',
        '--only filter fusion',
        '--json bench.json',
    )
    command.add_argument('--only', nargs='+', choices=GROUPS, default=GROUPS, metavar='GROUP', help=', '.join(GROUPS))
    command.add_argument('--json', metavar='FILE', help='write the table for machines')


def _do(options: argparse.Namespace) -> int:
    from wsn_tracking.benchmarks.table import benchmark, format_table, to_json
    from wsn_tracking.files import write_whole

    rows = []
    for row in benchmark(options.only):
        rows.append(row)
        if sys.stderr.isatty():
            print(f'\r\x1b[K{row.group}: {row.work}', end='', file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print('\r\x1b[K', end='', file=sys.stderr)
    print(format_table(rows))
    if options.json:
        write_whole(options.json, to_json(rows).encode())
    return 0
