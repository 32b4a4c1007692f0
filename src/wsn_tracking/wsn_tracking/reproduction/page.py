"""The report: one HTML file made of the JSON and of the words of `guide`, with nothing to fetch."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from typing import Any

from wsn_tracking.reproduction import guide
from wsn_tracking.reproduction.cross_reading import COLUMNS as READING
from wsn_tracking.reproduction.cross_reading import reading
from wsn_tracking.reproduction.digest import headline, number
from wsn_tracking.reproduction.drawings import svg
from wsn_tracking.reproduction.forest import forest, shown
from wsn_tracking.reproduction.verdicts import judged, verdicts

Json = Mapping[str, Any]

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: .6rem 0; font-size: 13px }
th, td { text-align: left; padding: .2rem .6rem; border-bottom: 1px solid #e4e4e4; vertical-align: top }
td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }
.v { border-radius: .6rem; padding: .05rem .55rem; font-size: 12px; white-space: nowrap; background: #eee }
.reproduced, .holds { background: #cfead6 } .in-shape { background: #e3eecb } .undecided { background: #fff2c2 }
.not-reproduced, .does-not-hold, .fails { background: #f6d2cb } .not-reproducible { background: #dcdcec }
code { font-size: 12px; background: #f4f4f4; padding: .1rem .3rem } img { max-width: 100% }
figure { display: inline-block; margin: .4rem 1rem .4rem 0; vertical-align: top }
section { border-top: 1px solid #ccc; margin-top: 1.4rem; padding-top: .2rem } .muted { color: #6b6b6b }
.wide { overflow-x: auto }
@media (min-width: 60rem) { figure.plot { width: 47.5% } figure.plot img { width: 100% } }
"""
FIGURES = (1, 2, 3)  # columns of numbers


def page(content: Json) -> str:
    """The whole report."""
    found = verdicts(content)
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        f'<title>Reproduction of five documents</title><style>{STYLE}</style></head><body>',
        *_opening(content, found),
        *_advice(found),
    ]
    for letter, document in guide.DOCUMENTS.items():
        claims = [claim for claim in content['claims'] if claim['document'] == letter]
        if not claims:
            continue
        parts += [f'<h2 id="{letter}">{letter}. {escape(document.title)}</h2>']
        parts += [f'<p class="muted">{escape(document.source)}</p><p>{escape(document.idea)}</p>']
        for kind, title in (('document', 'What the document says'), ('beyond', 'Beyond it')):
            some = [claim for claim in claims if claim['kind'] == kind]
            parts += [f'<h3>{title}</h3>'] if some else []
            parts += [_claim(claim, found[claim['id']], content['commit']) for claim in some]
    parts += [_table(table) for table in content.get('tables', ())]
    return '\n'.join([*parts, '</body></html>\n'])


def _opening(content: Json, found: Mapping[str, str]) -> Iterator[str]:
    """What was done, what came out, what the words mean."""
    yield '<h1>Five documents on tracking with wireless sensor networks, computed anew</h1>'
    yield from (
        f'<p>{escape(text)}</p>' for text in (*guide.WHAT, *([guide.COMPARED] if content.get('tables') else []))
    )
    documents = [letter for letter in guide.DOCUMENTS if any(c['document'] == letter for c in content['claims'])]
    links = [f'<a href="#{letter}">{letter}. {escape(guide.DOCUMENTS[letter].title)}</a>' for letter in documents]
    links += [f'<a href="#{table["id"]}">{escape(table["title"])}</a>' for table in content.get('tables', ())]
    yield f'<p>{"<br>".join(links)}</p><h2>How to read it</h2>'
    yield from (f'<p>{escape(text)}</p>' for text in guide.HOW)
    yield (
        f'<p>Made by <code>{escape(content["command"])}</code>, seed {content["seed"]}, commit '
        f'{escape(content["commit"])}{", with fewer runs (--quick)" if content["quick"] else ""}. The same numbers are '
        'in the JSON file beside this one, and every verdict follows from it.</p>'
    )
    counts = Counter(found.values())
    rows = [[_badge(word), str(counts[word]), escape(text)] for word, text in guide.WORDS.items() if counts[word]]
    yield _rows(['verdict', 'claims', 'meaning'], rows)
    rows = [
        [
            f'<a href="#{c["id"]}">{c["id"]}</a>',
            escape(c['place']),
            escape(c['statement']),
            _badge(found[c['id']]),
            _found(c),
        ]
        for c in content['claims']
    ]
    yield '<h2>All claims</h2>' + _rows(['', 'where', 'what', 'verdict', 'a figure that it rests on'], rows)


def _found(claim: Json) -> str:
    """What a claim comes down to."""
    name, document, ours, _ = headline(claim)
    told = f' (document: {document})' if document else ''
    return f'{escape(name)}: <b>{escape(ours)}</b>{escape(told)}' if name else ''


def _advice(found: Mapping[str, str]) -> Iterator[str]:
    """Which configuration when, with the claims that it rests on."""
    rows = []
    for when, what, why, ids in guide.ADVICE:
        rests = [f'<a href="#{i}">{i}</a> {_badge(found[i])}' for i in ids if i in found]
        if rests:
            rows.append([escape(when), _code(what), escape(why), ' '.join(rests)])
    if rows:
        yield f'<h2>Which configuration to use when</h2><p>{_code(guide.SETTING)}</p>'
        yield _rows(['you have', 'take', 'because', 'rests on'], rows)


def _claim(claim: Json, verdict: str, commit: str) -> str:
    rows = [
        [
            escape(f['name']),
            _number(f['document']),
            _number(f['value']),
            '' if None in f['interval_95'] else ' to '.join(_number(end) for end in f['interval_95']),
            escape(f['unit']),
            _rule(f, 'shape'),
            _rule(f, 'near'),
        ]
        for f in claim['figures']
    ]
    pictures = ''.join(_picture(plot) for plot in claim['plots']) or _intervals(claim)
    heads = ['', 'document', 'ours', '95 % interval', '', 'rule on the shape', 'rule on the number']
    used = [i for i in range(len(heads)) if any(row[i] for row in rows)]  # a column of nothing tells nothing
    if len(heads) - 1 not in used:
        heads[-2] = 'rule'
    heads, rows = [heads[i] for i in used], [[row[i] for i in used] for row in rows]
    figures = [k for k, i in enumerate(used) if i in FIGURES]
    runs = f'{claim["runs"]} runs, commit' if claim['runs'] else 'Commit'
    parts = [
        f'<section id="{claim["id"]}"><h4>{claim["id"]}, {escape(claim["place"])} {_badge(verdict)}</h4>',
        f'<p>{escape(claim["statement"])}</p>',
        f'<p><b>Why not:</b> {escape(claim["impossible"])}</p>' if claim['impossible'] else '',
        _rows(heads, rows, numbers=figures) if rows else '',
        pictures,
        f'<p>{_code(claim["remark"])}</p>' if claim['remark'] else '',
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
        words = f'≥ {_number(low)}' if high is None else f'≤ {_number(high)}'
    else:
        words = f'{_number(low)} to {_number(high)}'
    return f'{words} {_badge(judged(figure["interval_95"], bounds))}'


def _picture(plot: Json) -> str:
    return _image(plot['title'], svg(plot), 'plot')


def _intervals(claim: Json) -> str:
    """A claim that has no plot of its own, but figures."""
    return _image(f'{claim["id"]}: figures and rules', forest(claim), 'forest') if shown(claim['figures']) else ''


def _image(alt: str, drawn: bytes, kind: str) -> str:
    data = base64.b64encode(drawn).decode()
    return f'<figure class="{kind}"><img alt="{escape(alt)}" src="data:image/svg+xml;base64,{data}"></figure>'


def _table(table: Json) -> str:
    """One of the further tables."""
    measured = table.get('measured', {})
    columns = [*table['columns'], *measured]
    full = ([*row, *more] for row, *more in zip(table['rows'], *measured.values(), strict=True))
    rows = [[_number(cell) for cell in row] for row in full]
    words = ''.join(f'<p>{_code(text)}</p>' for text in table['text'])
    shown = _rows(columns, rows, numbers=range(2, len(columns))) if rows else ''
    if rows and table['id'] == 'cross':
        short = [[_number(cell) for cell in row] for row in reading(table)]
        shown = f'<h3>What it amounts to</h3>{_rows(READING, short, numbers=[2])}<h3>All of it</h3>{shown}'
    pictures = ''.join(_picture(plot) for plot in table.get('plots', ()))
    told = f'<p class="muted"><code>{escape(table["command"])}</code></p>'
    return f'<section id="{table["id"]}"><h2>{escape(table["title"])}</h2>{words}{shown}{pictures}{told}</section>'


def _rows(heads: Iterable[str], rows: Iterable[Iterable[str]], numbers: Iterable[int] = ()) -> str:
    """A table; its cells are HTML."""
    right = set(numbers)
    head = ''.join(f'<th>{escape(text)}</th>' for text in heads)
    body = ''.join(
        '<tr>'
        + ''.join(f'<td class="n">{c}</td>' if i in right else f'<td>{c}</td>' for i, c in enumerate(row))
        + '</tr>'
        for row in rows
    )
    return f'<div class="wide"><table><tr>{head}</tr>{body}</table></div>'


def _badge(word: str) -> str:
    return f'<span class="v {word.replace(" ", "-")}">{escape(word)}</span>'


def _code(text: str) -> str:
    """Text whose parts between backquotes are code."""
    parts = escape(text).split('`')
    return ''.join(f'<code>{part}</code>' if i % 2 else part for i, part in enumerate(parts))


def _number(value: Any) -> str:
    """A number or text of a cell."""
    return escape(number(value))
