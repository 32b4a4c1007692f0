"""Commands and links of the pages lead somewhere."""

from __future__ import annotations

import importlib.util
import re
import shlex

import pytest

from live import ROOT
from wsn_tracking.cli import _parser
from wsn_tracking.configuration import parse_setting
from wsn_tracking.simulation.scenarios import SCENARIOS
from wsn_tracking.studies import __main__ as by_runs
from wsn_tracking.studies import live as live_graph
from wsn_tracking.studies import serial
from wsn_tracking.studies.real_radio.__main__ import TABLES

PAGES = ['README.md', 'bags/README.md', *(f'docs/{path.name}' for path in sorted((ROOT / 'docs').glob('*.md')))]
TEXTS = {name: (ROOT / name).read_text('utf-8') for name in PAGES}
TRACKING = ('evaluate', 'replay', 'plot')
GENERAL = {'COMMAND', 'KIND', '[--bursts'}  # in words that tell how a command is called
NAMES = {
    'wsn_tracking.studies': {name for table in by_runs.STUDIES.values() for name in table},
    'wsn_tracking.studies.live': set(live_graph.STUDIES['live']),
    'wsn_tracking.studies.serial': set(serial.STUDIES['serial']),
    'wsn_tracking.studies.real_radio': set(TABLES),
}


def commands(begin):
    """Page and words of every command line that begins so, in blocks and in the text."""
    for page, text in TEXTS.items():
        joined = re.sub(r'\\\n\s*', '', text)
        spans = [
            ' '.join(span.split())
            for span in re.findall(r'`([^`]+)`', re.sub(r'```.*?```', '', joined, flags=re.DOTALL))
        ]
        for line in (*joined.splitlines(), *spans):
            for part in line.strip().split(' && '):
                if part.startswith(begin):
                    yield page, shlex.split(part.removeprefix(begin), comments=True)


@pytest.mark.parametrize(
    ('page', 'words'),
    [
        (page, words)
        for page, words in commands('./wsn-tracking ')
        if not GENERAL & set(words) and words != ['calibrate']
    ],
    ids=lambda value: ' '.join(value) if isinstance(value, list) else value,
)
def test_a_command_is_one_that_the_command_line_takes(page, words):
    options = _parser().parse_args(words)
    if options.command in TRACKING:
        for text in options.set:
            parse_setting(text)
    if options.command == 'simulate':
        assert options.scenario in SCENARIOS


@pytest.mark.parametrize(('page', 'words'), [*commands('./env python -m '), *commands('python -m wsn')], ids=str)
def test_a_module_that_is_run_is_there_and_knows_the_names(page, words):
    module = words[0] if words[0].startswith('wsn') else f'wsn{words[0]}'
    assert importlib.util.find_spec(module), (page, module)
    names = [word for word in words[1:] if re.fullmatch(r'[a-z_]+', word)]
    if module in NAMES:
        assert set(names) <= NAMES[module], page


@pytest.mark.parametrize('page', PAGES)
def test_links_lead_somewhere(page):
    for target, anchor in re.findall(r'\]\(([^)#]*)(?:#([^)]*))?\)', TEXTS[page]):
        path = (ROOT / page).parent / target if target else ROOT / page
        assert target.startswith('http') or path.exists(), target
        if anchor:
            headings = re.findall(r'^#+ (.*)$', path.read_text('utf-8'), re.MULTILINE)
            assert anchor in {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}


@pytest.mark.parametrize('page', PAGES)
def test_tests_and_modules_that_are_named_are_there(page):
    for name in re.findall(r'`(?:\w+/)*(test_\w+\.py)`', TEXTS[page]):
        assert [*ROOT.glob(f'test/{name}'), *ROOT.glob(f'src/*/test/{name}')], name
    for name in re.findall(r'`((?:\w+/)+\w+\.(?:py|yaml))`', TEXTS[page]):
        places = (
            ROOT,
            (ROOT / page).parent,
            ROOT / 'src' / 'wsn_tracking',
            ROOT / 'src' / 'wsn_tracking' / 'wsn_tracking',
        )
        assert any((place / name).exists() for place in places), name
