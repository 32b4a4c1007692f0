"""A disk that is full: the recorder says so in one line and ends, what it has written can be read, the others go on."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess

import pytest

import live
from wsn_tracking import graphs, processes
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError

TIMEOUT = 180.0  # [s]
SIZE_K = 64


def mounted(folder, words):
    """A command that runs with a disk of its own, so small, mounted on a folder that only it sees."""
    inside = f'mount -t tmpfs -o size={SIZE_K}k none {shlex.quote(str(folder))} && exec {shlex.join(words)}'
    return ['unshare', '-rm', 'sh', '-c', inside]


@pytest.fixture
def disk(tmp_path):
    """A small one. Skipped where this user may mount none: to fill the real one would harm others."""
    if (
        not shutil.which('unshare')
        or subprocess.run(mounted(tmp_path, ['true']), capture_output=True, check=False).returncode
    ):
        pytest.skip('a full disk is a small one of its own, and this user may mount none (unshare -rm)')
    (tmp_path / 'disk').mkdir()
    return tmp_path / 'disk'


def test_the_recorder_ends_with_one_line_and_the_rest_of_the_graph_goes_on(disk, tmp_path):
    record = {'output': str(disk / 'out'), 'extra_topics': ['estimate/fused_1']}
    settings = {'output_timeout': TIMEOUT}
    graph = graphs.replay(str(live.A_LOOP), rate=0.0, record=record, settings=settings)
    recorder = next(p for p in graph if p.name == 'bag_recorder')
    others = [p for p in graph if p.name != 'bag_recorder']
    with live.private_domain() as environment, live.started(others, environment) as running:
        words = processes.command(recorder, processes.write_parameters(recorder, tmp_path))
        # the disk is kept by a process that lives on for as long as we look at it
        copied = tmp_path / 'copied'
        script = f'{shlex.join(words)}; code=$?; cp -r {shlex.quote(str(disk))} {shlex.quote(str(copied))}; exit $code'
        running['bag_recorder'] = subprocess.Popen(
            mounted(disk, ['sh', '-c', script]),
            env=dict(environment),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        output, _ = running['bag_recorder'].communicate(timeout=TIMEOUT)
        assert running['bag_recorder'].returncode == 2, output
        live.wait_all(running, ['bag_player', 'evaluator'], TIMEOUT)
    assert 'No space left on device' in output
    assert 'Traceback' not in output
    try:
        found = 'messages' if read(copied / 'out').messages else 'nothing'
    except TrackingError as error:
        found = str(error)
    assert re.search('messages|metadata|truncated', found)  # what was received is kept, or what is missing is said
