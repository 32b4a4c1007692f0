"""Where the command line writes to: terminals, pipes, memory, readers that have gone."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys

import pytest
from graph_cases import a_loop

from wsn_tracking import cli
from wsn_tracking.bags.save import save
from wsn_tracking.cli import main


def test_a_reader_that_has_gone_is_no_error_of_ours(call, bags, monkeypatch):
    """As with `| head`: nothing is said, neither now nor when Python ends and writes what is left."""
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, 'w') as broken:
        monkeypatch.setattr(sys, 'stdout', broken)
        ended = call('info', bags / 'first')
    assert (ended.code, ended.err) == (141, '')


def test_a_name_that_the_terminal_cannot_show_is_no_reason_to_fail(call, tmp_path, monkeypatch):
    """A byte that is no UTF-8 in the name of a bag; a terminal that knows no more than ASCII."""
    odd = tmp_path / os.fsdecode(b'odd_\xff')
    save(odd, a_loop(2))
    seen = io.BytesIO()
    monkeypatch.setattr(sys, 'stdout', io.TextIOWrapper(seen, 'ascii'))
    assert call('evaluate', odd, '--set', 'peers=[1]', '--skip', 0).code == 0
    assert seen.getvalue().startswith(rb'odd_\udcff  target 1')


def test_output_may_go_into_memory(bags):
    with pytest.raises(SystemExit), contextlib.redirect_stdout(io.StringIO()) as out:
        main(['info', str(bags / 'first')])
    assert 'rssi' in out.getvalue()


def test_a_terminal_sees_progress_and_a_pipe_does_not(call, bags, monkeypatch):
    assert call('evaluate', bags / 'no_truth').err.count('\n') == 1
    monkeypatch.setattr(sys.stderr, 'isatty', lambda: True)
    ended = call('evaluate', bags / 'no_truth', '--set', 'peers=[1]')
    assert 'no_truth' in ended.err
    assert 'local_1' not in ended.err


@pytest.mark.parametrize('closed', ['stdout', 'stderr'])
def test_output_that_the_caller_has_closed_goes_nowhere(bags, closed):
    """`>&-`: a bag that is opened must not become standard output."""
    number = {'stdout': 1, 'stderr': 2}[closed]
    words = [sys.executable, '-m', 'wsn_tracking.cli', 'info', str(bags / 'first')]
    done = subprocess.run(
        ['/bin/sh', '-c', f'exec "$@" {number}>&-', 'sh', *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.returncode, done.stderr) == (0, '')
    assert ('rssi' in done.stdout) == (closed == 'stderr')


def test_ctrl_c_while_a_command_is_imported_says_nothing(call, monkeypatch):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, 'import_module', interrupted)
    ended = call('info', 'bag')
    assert (ended.code, ended.out, ended.err) == (130, '', '')
