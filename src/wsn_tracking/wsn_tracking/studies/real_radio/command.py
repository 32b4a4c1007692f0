"""How the studies of recordings are called: DATA, tables, and where the results go."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from wsn_tracking.errors import TrackingError
from wsn_tracking.studies.real_radio.sets import check_folder

Run = Callable[[Path, Path, Sequence[str]], Path]  # data, folder of the results, wanted tables -> what was written


def call(name: str, words: str, tables: Iterable[str], run: Run, arguments: Sequence[str] | None) -> int:
    """Run one of them as a program; the exit status."""
    parser = argparse.ArgumentParser(prog=f'wsn_tracking.studies.{name}', description=words)
    parser.add_argument('data', type=Path, metavar='DATA', help='folder of the recordings (docs/datasets.md)')
    parser.add_argument('names', nargs='*', metavar='NAME', help=f'tables (default: all): {", ".join(tables)}')
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder of the results')
    options = parser.parse_intermixed_args(arguments)
    try:
        check_folder(options.data)
        print(run(options.data, options.output, options.names))
    except TrackingError as error:
        print(f'{name.rpartition(".")[2]}: {error}', file=sys.stderr)
        return 1
    return 0
