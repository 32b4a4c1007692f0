"""Speed, measured in one run: ours, the peers', their ratio, the goal; as a table and as JSON."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from wsn_tracking.benchmarks import bags, consensus, filters, fusion, graph, nodes, particles, people, serial
from wsn_tracking.benchmarks.rows import Goal, Row, Sizes

GROUPS: Mapping[str, Callable[[Sizes], Iterable[Row]]] = {
    module.GROUP: module.rows
    for module in (
        filters,
        fusion,
        consensus,
        particles,
        bags,
        serial,
        graph,
        nodes,
        people,
    )
}
PACKAGES = ('numpy', 'scipy', 'filterpy', 'stonesoup', 'particles', 'mcap-ros2-support')
ALIGNED = '<><>><'
HEADINGS = ('work', 'ours', 'peer', 'ratio', 'goal', '')
FOOTNOTE = (
    'CPU time, medians, contenders in turns in one process; from graph on: processes, and clock time but for CPU.'
)


def benchmark(groups: Sequence[str] = tuple(GROUPS), sizes: Sizes | None = None) -> Iterator[Row]:
    """The rows of these groups, one after the other as they are measured."""
    for group in groups:
        yield from GROUPS[group](sizes or Sizes())


def format_table(rows: Sequence[Row]) -> str:
    """A line a row, a blank line between groups, notes below; no newline at the end."""
    notes = list(dict.fromkeys(row.note for row in rows if row.note))
    lines: list[tuple[str, ...]] = [HEADINGS]
    for before, row in zip((None, *rows), rows, strict=False):
        if before is not None and before.group != row.group:
            lines.append(('',) * len(HEADINGS))
        mark = f' [{notes.index(row.note) + 1}]' if row.note else ''
        lines.append((row.work + mark, _ours(row), _peer(row), _ratio(row), _goal(row.goal), _verdict(row)))
    widths = [max(len(line[i]) for line in lines) for i in range(len(HEADINGS))]
    text = ['  '.join(map(_padded, line, widths, ALIGNED)).rstrip() for line in lines]
    return '\n'.join([*text, '', FOOTNOTE, *(f'[{i + 1}] {note}' for i, note in enumerate(notes))])


def to_json(rows: Sequence[Row]) -> str:
    """The same for machines, with what they ran on; numbers that are not known are null."""
    content = {
        'machine': {'processor': platform.machine(), 'cores': os.cpu_count(), 'python': platform.python_version()},
        'packages': {name: _version(name) for name in PACKAGES},
        'rows': [_plain(row) for row in rows],
    }
    return json.dumps(content, indent=2, allow_nan=False) + '\n'


def _plain(row: Row) -> dict[str, Any]:
    goal = row.goal
    return {
        'group': row.group,
        'work': row.work,
        'unit': row.unit,
        'ours': row.ours,
        'peer': row.peer or None,
        'theirs': row.theirs,
        'ratio': row.ratio,
        'goal': None if goal is None else {'of': 'ratio' if goal.of_ratio else 'ours', _bound(goal): goal.limit},
        'met': None if goal is None else goal.met(row),
        'note': row.note or None,
    }


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _bound(goal: Goal) -> str:
    return 'at_least' if goal.at_least else 'at_most'


def _padded(cell: str, width: int, aligned: str) -> str:
    return f'{cell:{aligned}{width}}'


def _figure(value: float | None) -> str:
    """Three digits that count."""
    if value is None:
        return '-'
    if 0.0 < abs(value) < 1e-3:
        return f'{value:.2g}'
    return np.format_float_positional(value, 3, fractional=False, trim='-')


def _ours(row: Row) -> str:
    return f'{_figure(row.ours)} {row.unit}'.strip()


def _peer(row: Row) -> str:
    return f'{row.peer} {_figure(row.theirs)} {row.unit}'.strip() if row.peer else ''


def _ratio(row: Row) -> str:
    return '' if row.ratio is None else f'{_figure(row.ratio)} x'


def _goal(goal: Goal | None) -> str:
    if goal is None:
        return ''
    return f'{">=" if goal.at_least else "<="} {goal.limit:g}{" x" if goal.of_ratio else ""}'


def _verdict(row: Row) -> str:
    met = None if row.goal is None else row.goal.met(row)
    return '' if met is None else 'ok' if met else 'not met'
