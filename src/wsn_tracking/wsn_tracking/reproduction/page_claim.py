"""A claim in the report."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from wsn_tracking.reproduction.drawings import svg
from wsn_tracking.reproduction.forest import forest, shown
from wsn_tracking.reproduction.markup import badge, cell, code, image, rows_of
from wsn_tracking.reproduction.verdicts import judged

Json = Mapping[str, Any]
FIGURES = (1, 2, 3)  # columns of numbers


def section(claim: Json, verdict: str, commit: str) -> str:
    """Statement, figures with their rules, picture, remark, command."""
    rows = [
        [
            escape(f['name']),
            cell(f['document']),
            cell(f['value']),
            '' if None in f['interval_95'] else ' to '.join(cell(end) for end in f['interval_95']),
            escape(f['unit']),
            _rule(f, 'shape'),
            _rule(f, 'near'),
        ]
        for f in claim['figures']
    ]
    pictures = ''.join(picture(plot) for plot in claim['plots']) or _intervals(claim)
    heads = ['', 'document', 'ours', '95 % interval', '', 'rule on the shape', 'rule on the number']
    used = [i for i in range(len(heads)) if any(row[i] for row in rows)]  # a column of nothing tells nothing
    if len(heads) - 1 not in used:
        heads[-2] = 'rule'
    heads, rows = [heads[i] for i in used], [[row[i] for i in used] for row in rows]
    figures = [k for k, i in enumerate(used) if i in FIGURES]
    runs = f'{claim["runs"]} runs, commit' if claim['runs'] else 'Commit'
    parts = [
        f'<section id="{claim["id"]}"><h4>{claim["id"]}, {escape(claim["place"])} {badge(verdict)}</h4>',
        f'<p>{escape(claim["statement"])}</p>',
        f'<p><b>Why not:</b> {escape(claim["impossible"])}</p>' if claim['impossible'] else '',
        rows_of(heads, rows, numbers=figures) if rows else '',
        pictures,
        f'<p>{code(claim["remark"])}</p>' if claim['remark'] else '',
        f'<p class="muted">{runs} {escape(commit)}. <code>{escape(claim["command"])}</code></p>',
        '</section>',
    ]
    return '\n'.join(part for part in parts if part)


def _rule(figure: Json, kind: str) -> str:
    """A rule in words, and whether it holds."""
    bounds = figure[kind]
    if bounds is None:
        return ''
    low, high = bounds
    if low is None or high is None:
        words = f'≥ {cell(low)}' if high is None else f'≤ {cell(high)}'
    else:
        words = f'{cell(low)} to {cell(high)}'
    return f'{words} {badge(judged(figure["interval_95"], bounds))}'


def picture(plot: Json) -> str:
    """A plot of the JSON."""
    return image(plot['title'], svg(plot), 'plot')


def _intervals(claim: Json) -> str:
    """A claim that has no plot of its own, but figures."""
    return image(f'{claim["id"]}: figures and rules', forest(claim), 'forest') if shown(claim['figures']) else ''
