"""Numbers that a page quotes."""

import json
import re

import pytest

from live import ROOT

NUMBER = r'(-?\d+(?:\.\d+)?)'


def page(name):
    """The text of docs/NAME.md."""
    return (ROOT / 'docs' / f'{name}.md').read_text('utf-8')


def results(name):
    """What is committed as docs/results/NAME.json."""
    return json.loads((ROOT / 'docs' / 'results' / f'{name}.json').read_text('utf-8'))


def told(words, text):
    """The numbers that stand where `words` have a @; once in the text, wherever its lines end."""
    pattern = NUMBER.join(map(re.escape, ' '.join(words.split()).split('@')))
    (found,) = re.findall(pattern, ' '.join(text.split()))
    return [found] if isinstance(found, str) else list(found)


def quoted(*pairs):
    """That numbers are quoted to within one unit of their last digit, as they are printed."""
    for text, value in pairs:
        assert float(text) == pytest.approx(value, abs=0.51 * 10.0 ** -len(text.partition('.')[2])), (text, value)


def table(page, title):
    """Cells of every row of the table of a page whose heading row begins so."""
    lines = page[page.index(f'\n| {title}') + 1 :].split('\n\n')[0].split('\n')[2:]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


def numbers(*cells):
    """The numbers in some cells."""
    return [float(text) for cell in cells for text in texts(cell)]


def texts(cell):
    """The numbers in a cell as they are printed."""
    return re.findall(r'(?<![\w.])[-+]?\d+(?:\.\d+)?(?!\w)', cell)
