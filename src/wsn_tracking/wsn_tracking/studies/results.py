"""How the figures of studies are made and kept: a JSON file a table, below docs/results.

A study is a function without arguments that returns what is worth keeping: numbers, seeds, no times and no paths.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.files import write_whole

Result = dict[str, Any]  # of a study, ready for JSON
Study = Callable[[], Result]
Studies = Mapping[str, Mapping[str, Study]]  # file: its studies by name


def call(module: str, words: str, studies: Studies, arguments: Sequence[str] | None) -> int:
    """Run a module's studies as a program; the exit status."""
    parser = argparse.ArgumentParser(prog=module, description=words)
    names = ', '.join(name for table in studies.values() for name in table)
    parser.add_argument('names', nargs='*', metavar='NAME', help=f'studies to run (default: all): {names}')
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder of the results')
    options = parser.parse_intermixed_args(arguments)
    try:
        for path in make(options.output, options.names, studies, command=f'python -m {module} -o docs/results'):
            print(path)
    except TrackingError as error:
        print(f'{module.rpartition(".")[2]}: {error}', file=sys.stderr)
        return 1
    return 0


def make(folder: Path, wanted: Sequence[str], studies: Studies, *, command: str) -> list[Path]:
    """Run the wanted studies (none: all) and write one file a table; figures of studies that are not run stay."""
    known = [name for table in studies.values() for name in table]
    for name in wanted:
        if name not in known:
            raise TrackingError(f'there is no study `{name}`: expected some of {", ".join(known)}')
    written = []
    for file, table in studies.items():
        chosen = [name for name in table if not wanted or name in wanted]
        if not chosen:
            continue
        path = folder / f'{file}.json'
        _kept(path)  # a file that is none is refused before the work
        made = {}
        for name in chosen:
            print(f'{file}: {name}', file=sys.stderr, flush=True)
            made[name] = {'what': _first_line(table[name]), **table[name]()}
        kept = {name: value for name, value in _kept(path).items() if name in table}  # another run may have added some
        results = {**kept, **made}
        text = json.dumps({'command': command, 'studies': results}, indent=2, sort_keys=True, allow_nan=False)
        write_whole(path, text.encode() + b'\n')
        written.append(path)
    return written


def _kept(path: Path) -> Result:
    """The figures of an earlier run."""
    if not path.exists():
        return {}
    try:
        return dict(json.loads(path.read_bytes())['studies'])
    except (ValueError, KeyError, TypeError) as error:
        raise TrackingError(f'{path} holds no figures of a study: delete it, or name another folder') from error


def _first_line(study: Study) -> str:
    return (study.__doc__ or '').strip().split('\n', 1)[0]
