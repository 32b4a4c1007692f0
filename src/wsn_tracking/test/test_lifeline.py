"""Processes that end with the one that started them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from wsn_tracking.lifeline import PARENT, tied

TIMEOUT = 60.0  # [s] far beyond what a Python takes to start or to end
CHILD = """
import os, signal
from wsn_tracking.lifeline import PARENT, follow
follow()
print(PARENT in os.environ, flush=True)
signal.pause()
"""
PARENT_OF_IT = f"""
import os, signal, subprocess, sys
from wsn_tracking.lifeline import tied
subprocess.Popen([sys.executable, '-c', {CHILD!r}], env=tied(os.environ), start_new_session=True)
signal.pause()
"""


@pytest.mark.skipif(sys.platform != 'linux', reason='the system tells of a parent that has ended on Linux alone')
def test_who_was_started_ends_with_a_parent_that_is_killed():
    parent = subprocess.Popen([sys.executable, '-c', PARENT_OF_IT], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    assert parent.stdout.readline() == 'False\n'  # the child is there, and passes the request on to nobody
    parent.kill()
    parent.communicate(timeout=TIMEOUT)  # the pipe ends with the child, who holds it, too


@pytest.mark.skipif(sys.platform != 'linux', reason='the system tells of a parent that has ended on Linux alone')
def test_who_starts_after_its_parent_has_ended_ends_at_once():
    gone = subprocess.Popen([sys.executable, '-c', ''])
    gone.wait(TIMEOUT)
    environment = {**os.environ, PARENT: str(gone.pid)}
    late = subprocess.run([sys.executable, '-c', CHILD], env=environment, timeout=TIMEOUT, check=False)
    assert late.returncode == -signal.SIGTERM


def test_nobody_is_followed_who_did_not_ask_for_it():
    words = CHILD.replace('signal.pause()', '')
    free = subprocess.run([sys.executable, '-c', words], timeout=TIMEOUT, check=False, stdout=subprocess.DEVNULL)
    assert free.returncode == 0


def test_the_environment_that_asks_for_it_is_otherwise_the_callers():
    assert tied({'a': 'b'}) == {'a': 'b', PARENT: str(os.getpid())}
