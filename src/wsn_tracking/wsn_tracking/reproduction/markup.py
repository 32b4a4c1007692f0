"""Parts of an HTML page: tables, badges, pictures."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from typing import Any

from wsn_tracking.reproduction.digest import number

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


def rows_of(heads: Iterable[str], rows: Iterable[Iterable[str]], numbers: Iterable[int] = ()) -> str:
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


def badge(word: str) -> str:
    """A verdict in its colour."""
    return f'<span class="v {word.replace(" ", "-")}">{escape(word)}</span>'


def code(text: str) -> str:
    """Text whose parts between backquotes are code."""
    parts = escape(text).split('`')
    return ''.join(f'<code>{part}</code>' if i % 2 else part for i, part in enumerate(parts))


def cell(value: Any) -> str:
    """A number or text of a cell."""
    return escape(number(value))


def image(alt: str, drawn: bytes, kind: str) -> str:
    """A drawing within the page; `kind` styles it."""
    data = base64.b64encode(drawn).decode()
    return f'<figure class="{kind}"><img alt="{escape(alt)}" src="data:image/svg+xml;base64,{data}"></figure>'
