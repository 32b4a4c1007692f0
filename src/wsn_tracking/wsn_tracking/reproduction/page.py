"""The report: one HTML file made of the JSON and of the words of `guide`, with nothing to fetch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from wsn_tracking.reproduction import guide
from wsn_tracking.reproduction.cross_reading import COLUMNS as READING
from wsn_tracking.reproduction.cross_reading import reading
from wsn_tracking.reproduction.digest import headline
from wsn_tracking.reproduction.markup import STYLE, badge, cell, code, rows_of
from wsn_tracking.reproduction.page_claim import picture, section
from wsn_tracking.reproduction.verdicts import verdicts

Json = Mapping[str, Any]


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
            parts += [section(claim, found[claim['id']], content['commit']) for claim in some]
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
    rows = [[badge(word), str(counts[word]), escape(text)] for word, text in guide.WORDS.items() if counts[word]]
    yield rows_of(['verdict', 'claims', 'meaning'], rows)
    rows = [
        [
            f'<a href="#{c["id"]}">{c["id"]}</a>',
            escape(c['place']),
            escape(c['statement']),
            badge(found[c['id']]),
            _found(c),
        ]
        for c in content['claims']
    ]
    yield '<h2>All claims</h2>' + rows_of(['', 'where', 'what', 'verdict', 'a figure that it rests on'], rows)


def _found(claim: Json) -> str:
    """What a claim comes down to."""
    name, document, ours, _ = headline(claim)
    told = f' (document: {document})' if document else ''
    return f'{escape(name)}: <b>{escape(ours)}</b>{escape(told)}' if name else ''


def _advice(found: Mapping[str, str]) -> Iterator[str]:
    """Which configuration when, with the claims that it rests on."""
    rows = []
    for when, what, why, ids in guide.ADVICE:
        rests = [f'<a href="#{i}">{i}</a> {badge(found[i])}' for i in ids if i in found]
        if rests:
            rows.append([escape(when), code(what), escape(why), ' '.join(rests)])
    if rows:
        yield f'<h2>Which configuration to use when</h2><p>{code(guide.SETTING)}</p>'
        yield rows_of(['you have', 'take', 'because', 'rests on'], rows)


def _table(table: Json) -> str:
    """One of the further tables."""
    measured = table.get('measured', {})
    columns = [*table['columns'], *measured]
    full = ([*row, *more] for row, *more in zip(table['rows'], *measured.values(), strict=True))
    rows = [[cell(value) for value in row] for row in full]
    words = ''.join(f'<p>{code(text)}</p>' for text in table['text'])
    shown = rows_of(columns, rows, numbers=range(2, len(columns))) if rows else ''
    if rows and table['id'] == 'cross':
        short = [[cell(value) for value in row] for row in reading(table)]
        shown = f'<h3>What it amounts to</h3>{rows_of(READING, short, numbers=[2])}<h3>All of it</h3>{shown}'
    pictures = ''.join(picture(plot) for plot in table.get('plots', ()))
    told = f'<p class="muted"><code>{escape(table["command"])}</code></p>'
    return f'<section id="{table["id"]}"><h2>{escape(table["title"])}</h2>{words}{shown}{pictures}{told}</section>'
