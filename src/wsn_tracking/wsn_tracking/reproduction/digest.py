"""The JSON of a reproduction in short, as Markdown: a line a claim, and the further tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from wsn_tracking.reproduction.verdicts import verdicts

Json = Mapping[str, Any]


def digest(content: Json) -> str:
    """All of it."""
    return '\n'.join([*_head(content), '', *_claims(content), *_tables(content), ''])


def _head(content: Json) -> Iterator[str]:
    yield '# Reproduction of five documents, in short'
    yield ''
    yield f'Made by `{content["command"]}`, commit {content["commit"]}. The first figure that a verdict rests on stands'
    yield 'beside each claim; all others, plots and rules are in the report that the same command writes.'


def _claims(content: Json) -> Iterator[str]:
    found = verdicts(content)
    rows = [
        [claim['id'], claim['place'], claim['statement'], f'**{found[claim["id"]]}**', *headline(claim)]
        for claim in content['claims']
    ]
    yield from _rows(['', 'where', 'what', 'verdict', 'figure', 'document', 'ours', '95 % interval'], rows)


def headline(claim: Json) -> list[str]:
    """Name, the document's, ours and its interval of the first figure with a rule, or the first of all."""
    ruled = [f for f in claim['figures'] if f['shape'] or f['near']] or claim['figures']
    if not ruled:
        return ['', '', '', '']
    first = ruled[0]
    ends = '' if None in first['interval_95'] else ' to '.join(number(end) for end in first['interval_95'])
    ours = f'{number(first["value"])} {first["unit"]}'.strip()
    return [first['name'], number(first['document']), ours, ends]


def _tables(content: Json) -> Iterator[str]:
    for table in content.get('tables', ()):
        measured = table.get('measured', {})
        full = ([*row, *more] for row, *more in zip(table['rows'], *measured.values(), strict=True))
        yield from ('', f'## {table["title"]}', '', '\n\n'.join(table['text']), '', f'`{table["command"]}`', '')
        yield from _rows([*table['columns'], *measured], [[number(cell) for cell in row] for row in full])


def _rows(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield f'| {" | ".join(heads)} |'
    yield f'|{"---|" * len(heads)}'
    yield from (f'| {" | ".join(cell.replace("|", "&#124;") for cell in row)} |' for row in rows)


def number(value: Any) -> str:
    """Four digits, no exponent unless it is needed; what is unknown is empty."""
    if value is None:
        return ''
    if isinstance(value, (str, int)):
        return str(value)
    return f'{value:.0f}' if 1e4 > abs(value) >= 1e3 else f'{value:.4g}'
