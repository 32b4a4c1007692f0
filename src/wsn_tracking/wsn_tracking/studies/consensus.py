"""What the consensus schemes reach and what they cost (seed 002): a table for the docs, and figures for machines.

    python -m wsn_tracking.studies.consensus -o docs/results [--runs N]

Writes consensus.json and consensus.md. Times are of the machine that ran it; everything else is repeatable.
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
from wsn_tracking.simulation.b_field import FieldConfig
from wsn_tracking.studies import consensus_runs as runs_of
from wsn_tracking.studies.consensus_faults import faults, links
from wsn_tracking.studies.consensus_parts import deaths, parts
from wsn_tracking.studies.consensus_scaling import scaling
from wsn_tracking.studies.consensus_schemes import Table, schemes, ten_bytes

COMMAND = 'python -m wsn_tracking.studies.consensus -o docs/results'
SEED = 1
RAW_RUNS = 20  # of floods of readings, which cost fifty times the others


def study(runs: int) -> Mapping[str, Table]:
    """All tables."""
    field = FieldConfig()
    worlds = runs_of.sample(field, runs, SEED)
    tables: Mapping[str, Callable[[], Table]] = {
        'schemes': lambda: schemes(worlds),
        'ten_bytes': lambda: ten_bytes(runs_of.some(worlds, slice(0, RAW_RUNS))),
        'faults': lambda: faults(field, runs, SEED),
        'links': lambda: links(worlds),
        'deaths': lambda: deaths(worlds),
        'parts': lambda: parts(field, 10 * runs, SEED),
        'scaling': lambda: scaling(field, 100 * runs * 10, SEED),
    }
    results = {}
    for name, make in tables.items():
        print(f'consensus: {name}', file=sys.stderr, flush=True)
        results[name] = make()
    return results


def markdown(tables: Mapping[str, Table], runs: int) -> str:
    """The tables as text."""
    lines = [f'<!-- made by {COMMAND}; {runs} runs, seed {SEED} -->']
    for name, table in tables.items():
        columns = list(dict.fromkeys(key for row in table for key in row))
        lines += ['', f'### {name}', '', f'| {" | ".join(columns)} |', f'|{"---|" * len(columns)}']
        lines += [f'| {" | ".join(_cell(row.get(column, "")) for column in columns)} |' for row in table]
    return '\n'.join(lines) + '\n'


def _cell(value: Any) -> str:
    return f'{value:.4g}' if isinstance(value, float) else str(value)


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    parser = argparse.ArgumentParser(prog='wsn_tracking.studies.consensus', description=__doc__.split('\n')[0])
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='DIR', help='folder of the results')
    parser.add_argument('--runs', type=int, default=100, help='runs of each row (default: 100)')
    options = parser.parse_args(arguments)
    try:
        tables = study(options.runs)
        content = {'command': COMMAND, 'runs': options.runs, 'seed': SEED, 'tables': tables}
        text = json.dumps(content, indent=2, allow_nan=False) + '\n'
        write_whole(options.output / 'consensus.json', text.encode())
        write_whole(options.output / 'consensus.md', markdown(tables, options.runs).encode())
    except TrackingError as error:
        print(f'consensus: {error}', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())
