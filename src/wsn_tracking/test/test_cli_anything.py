"""No arguments end in a traceback."""

from __future__ import annotations

import os
from pathlib import Path

from cli_cases import Called
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

OPTIONS = [
    '--json',
    '--set',
    '--target',
    '--skip',
    '--config',
    '--rate',
    '--seed',
    '--record',
    '-o',
    '--namespace',
    '--live',
    '--trackers',
    '--channel',
    '--until',
    '--',
    '-',
    '-h',
    '--one-process-each',
]
WORDS = [
    'BAG',
    'a_loop',
    'danis',
    'max',
    '1',
    '-1',
    'nan',
    '1e400',
    'peers=[1]',
    'peers=',
    'area=[0,0,1,1]',
    'trigger.kind=near',
    'start.epochs=1',
    'noise.q_max=1e308',
    '/',
    '.',
    '..',
    '/dev/null',
    '/dev/zero/x',
]
LETTERS = 'abz019.,=-[]{}:!&*\'"%\\/ \n\t~é漢\U0001f4a9\udcff'
junk = st.one_of(st.text(LETTERS, max_size=12), st.sampled_from(WORDS))
UNHURRIED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@given(
    st.sampled_from(['evaluate', 'replay', 'info', 'simulate', 'import', 'calibrate']),
    st.booleans(),
    st.lists(st.one_of(junk, st.tuples(st.sampled_from(OPTIONS), junk)), max_size=4),
)
@settings(max_examples=50, suppress_health_check=UNHURRIED)
def test_no_arguments_end_in_a_traceback(bags, started, capsys, tmp_path_factory, command, with_bag, words):
    flat = [word for entry in words for word in ([entry] if isinstance(entry, str) else entry)]
    if with_bag:
        flat.insert(0, 'BAG')
    here = Path.cwd()
    os.chdir(tmp_path_factory.mktemp('run'))
    try:
        ended = Called(capsys, command, *(word.replace('BAG', str(bags / 'no_truth')) for word in flat))
    finally:
        os.chdir(here)
    assert ended.code in {0, 1, 2}
    assert 'Traceback' not in ended.err
    if ended.code:
        assert ended.err
