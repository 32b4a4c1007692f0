"""Scores as plain text: ASCII, at most 100 columns, coloured only on a terminal."""

from __future__ import annotations

import math
import os
import textwrap
from collections.abc import Mapping, Sequence
from typing import TextIO

from wsn_tracking.evaluation.score import Score, pool
from wsn_tracking.evaluation.summary import Summary, Traffic, pool_summaries

WIDTH = 100
MANY, FEW = 12, 3  # more outputs of one kind than MANY are pooled into one row, with the first FEW below it
NAME_WIDTH = (6, 40)  # least and most columns of an output's name
COLUMNS = ('RMSE', 'median', 'p95', 'EI', 'ESI x', 'ESI y', 'NEES', '95 % of NEES', '', 'epochs')
BOLD, DIM, GREEN, RED, YELLOW, PLAIN = (f'\x1b[{code}m' for code in (1, 2, 32, 31, 33, 0))
VERDICT_COLOUR = {'ok': GREEN, 'high': RED, 'low': YELLOW}
FOOTNOTE = (
    'NEES: squared position error against its own covariance; 2 is right, high is overconfident, low is too '
    'cautious. Its interval counts independent epochs, estimated from the autocorrelation of the NEES. '
    'EI: mean of |ex| + |ey|. ESI: sum of |ex|, of |ey|.'
)


def format_table(summary: Summary, *, colour: bool = False, footnote: bool = True) -> str:
    """The table of one bag: a row an output, then what became of the measurements; no newline at the end."""
    target = '' if summary.target_id is None else f'  target {summary.target_id}'
    lines = [_paint(_fit(f'{summary.title}{target}', WIDTH), BOLD, colour)]
    outputs = _legible(summary.outputs)
    lines += _score_lines(outputs, colour)
    lines.append(f'epochs     {summary.epochs}, errors scored from {summary.skip_s:g} s after the start')
    lines.append(_sent_line(summary.traffic))
    dropped = ', '.join(f'{_words(reason)} {n}' for reason, n in sorted(summary.input.items()) if n)
    lines += _wrapped('dropped    ', dropped or 'nothing')
    missing = _missing(outputs)
    if missing:
        lines += _wrapped('not scored ', missing)
    if footnote:
        lines += [_paint(line, DIM, colour) for line in textwrap.wrap(FOOTNOTE, WIDTH)]
    return '\n'.join(lines)


def _legible(outputs: Mapping[str, Score]) -> Mapping[str, Score]:
    """The rows of the table: nodes of a large network are pooled, since nobody reads a row for each.

    Nodes that agree err alike, so the pooled NEES has no more independent epochs than one of them.
    """
    kinds: dict[str, list[str]] = {}
    for name in outputs:
        kinds.setdefault(name.rpartition('_')[0] or name, []).append(name)
    rows: dict[str, Score] = {}
    for kind, names in kinds.items():
        if len(names) > MANY:
            every = [outputs[name] for name in names]
            rows[f'{kind} (all {len(names)})'] = pool(every)._replace(nees_interval=every[0].nees_interval)
        rows.update((name, outputs[name]) for name in (names[:FEW] if len(names) > MANY else names))
    return rows


def format_tables(summaries: Sequence[Summary], *, colour: bool = False) -> str:
    """A table a bag, and with several bags their pooled one last."""
    every = [*summaries, pool_summaries(summaries)] if len(summaries) > 1 else list(summaries)
    last = len(every) - 1
    return '\n\n'.join(format_table(s, colour=colour, footnote=i == last) for i, s in enumerate(every))


def wants_colour(stream: TextIO) -> bool:
    """Colour only for a terminal that understands it and a user who did not set NO_COLOR."""
    return stream.isatty() and not os.environ.get('NO_COLOR') and os.environ.get('TERM', 'dumb') != 'dumb'


def nees_verdict(score: Score) -> str:
    """`ok`, `high` (overconfident), `low` (too cautious), or nothing where NEES is not known."""
    low, high = score.nees_interval
    if math.isnan(score.nees) or math.isnan(low):
        return ''
    return 'high' if score.nees > high else 'low' if score.nees < low else 'ok'


def number(value: float) -> str:
    """Three decimals, fewer for large values, `-` for an unknown one; at most 7 characters."""
    if math.isnan(value):
        return '-'
    if abs(value) >= 99999.5:
        return f'{value:.1e}'
    return f'{value:.3f}' if abs(value) < 99.9995 else f'{value:.1f}'


def _score_lines(outputs: Mapping[str, Score], colour: bool) -> list[str]:
    if not outputs:
        return ['no output']
    cells = [list(COLUMNS), ['m'] * 6 + [''] * 4]
    for score in outputs.values():
        low, high = score.nees_interval
        lengths = (score.rmse_m, score.median_m, score.p95_m, score.ei_m, *score.esi_m)
        interval = '-' if math.isnan(low) else f'[{low:.2f}, {high:.2f}]'
        row = [*map(number, lengths), _nees(score.nees), interval, nees_verdict(score), str(score.epochs)]
        cells.append(row)
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    room = WIDTH - sum(widths) - 2 * len(widths)
    longest = max(NAME_WIDTH[0], *(len(name) for name in outputs))
    name_width = max(NAME_WIDTH[0], min(longest, room, NAME_WIDTH[1]))
    lines = []
    for i, (name, row) in enumerate(zip(['output', '', *outputs], cells, strict=True)):
        padded = [f'{cell:>{width}}' for cell, width in zip(row, widths, strict=True)]
        if i >= 2:
            padded[8] = _paint(padded[8], VERDICT_COLOUR.get(row[8], PLAIN), colour and bool(row[8]))
        line = '  '.join([f'{_fit(name, name_width):<{name_width}}', *padded])
        lines.append(_paint(line.rstrip(), DIM, colour) if i < 2 else line)
    return lines


def _sent_line(t: Traffic) -> str:
    """How much of what could have been sent was sent."""
    if not t.received and not t.on_board:
        return 'sent       not known: the bag holds no trigger report'
    if t.on_board:
        return f'sent       {t.sent}; the motes themselves held {t.on_board} back'
    of_radius = f' ({100.0 * t.share:.1f} %)' if t.in_radius else ''
    of_received = f' ({100.0 * t.sent / t.received:.1f} %)'
    return f'sent       {t.sent} of {t.in_radius} in radius{of_radius}, of {t.received} received{of_received}'


def _missing(outputs: Mapping[str, Score]) -> str:
    """Estimates that carry no error or no NEES, by output.

    What was skipped on purpose is not missing, nor the NEES of an output that never has a covariance.
    """
    told = []
    for name, score in outputs.items():
        counts = {**score.unscored, **(score.without_nees if score.nees_epochs else {})}
        reasons = [f'{_words(reason)} {n}' for reason, n in counts.items() if n and reason != 'skipped']
        if reasons:
            told.append(f'{name}: {", ".join(reasons)}')
    return '; '.join(told)


def _nees(value: float) -> str:
    return '-' if math.isnan(value) else f'{value:.2f}' if value < 9999.5 else f'{value:.1e}'


def _words(reason: str) -> str:
    return reason.replace('_', ' ')


def _fit(text: str, width: int) -> str:
    return text if len(text) <= width else text[: width - 1] + '~'


def _wrapped(label: str, text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=label, subsequent_indent=' ' * len(label))


def _paint(text: str, code: str, colour: bool) -> str:
    return f'{code}{text}{PLAIN}' if colour else text
