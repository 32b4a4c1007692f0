"""How the figures of studies are made and kept: a JSON file a table, below docs/results.

A study is a function without arguments that returns what is worth keeping: numbers, seeds, no times and no paths.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from wsn_tracking.errors import TrackingError
from wsn_tracking.files import write_whole

Study = Callable[[], dict[str, Any]]


def make(
    folder: Path,
    wanted: Sequence[str],
    studies: Mapping[str, Mapping[str, Study]],
    *,
    command: str,
) -> list[Path]:
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


def _kept(path: Path) -> dict[str, Any]:
    """The figures of an earlier run."""
    if not path.exists():
        return {}
    try:
        return dict(json.loads(path.read_bytes())['studies'])
    except (ValueError, KeyError, TypeError) as error:
        raise TrackingError(f'{path} holds no figures of a study: delete it, or name another folder') from error


def _first_line(study: Study) -> str:
    return (study.__doc__ or '').strip().split('\n', 1)[0]
