"""A graph over two hosts: two network namespaces with a cable between them, and no setting that tells of it."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess

import pytest

import live
from feeding import first_epochs
from wsn_tracking import graphs
from wsn_tracking.bags.estimates import differences, read_estimates
from wsn_tracking.bags.save import save
from wsn_tracking.offline import offline

FAR = {'estimator_2', 'estimator_3', 'evaluator'}  # on the second host; the feed, sensing and the recorder on the first


@pytest.fixture
def hosts():
    """The names of two namespaces that reach each other, and nothing else."""
    names = [f'wsn{os.getpid()}{end}' for end in 'ab']
    with contextlib.ExitStack() as stack:
        try:
            for name in names:
                ip('netns', 'add', name)
                stack.callback(ip, 'netns', 'delete', name)
            ip('link', 'add', 'cable', 'netns', names[0], 'type', 'veth', 'peer', 'name', 'cable', 'netns', names[1])
        except (OSError, subprocess.CalledProcessError) as error:
            pytest.skip(f'no network namespaces here: {error}')
        for number, name in enumerate(names, 1):
            ip('-n', name, 'address', 'add', f'10.77.0.{number}/24', 'dev', 'cable')
            for device in ('lo', 'cable'):
                ip('-n', name, 'link', 'set', device, 'up')
        yield names


def ip(*words):
    subprocess.run([shutil.which('ip') or 'ip', *words], check=True, capture_output=True)


def test_a_graph_over_two_hosts_gives_what_one_process_computes(hosts, tmp_path):
    """Bit for bit, though half of the fusion is on the other side."""
    bag, out = tmp_path / 'bag', tmp_path / 'out'
    save(bag, first_epochs(graphs.open_bag(str(live.A_LOOP))[1], 40))
    run = offline(*graphs.open_bag(str(bag)))
    names = [f'{kind}_{i}' for kind in ('local', 'fused') for i in (1, 2, 3)]
    record = {'output': str(out), 'extra_topics': [f'estimate/{name}' for name in names]}
    graph = graphs.replay(str(bag), rate=0.0, record=record, settings=live.PATIENT)
    assert {process.name for process in graph} > FAR
    with live.private_domain() as environment:
        plain = {name: value for name, value in environment.items() if name != 'ROS_AUTOMATIC_DISCOVERY_RANGE'}
        with contextlib.ExitStack() as stack:
            running = {}
            for host, there in zip(hosts, (False, True), strict=True):
                part = [process for process in graph if (process.name in FAR) is there]
                running |= stack.enter_context(live.started(part, plain, ('ip', 'netns', 'exec', host)))
            live.wait_all(running, ['bag_player', 'evaluator', 'bag_recorder'], live.TIMEOUT)
    published = read_estimates(out)
    assert set(published) == set(names)
    for name, estimates in published.items():
        assert len(estimates) == 40
        assert differences(estimates, run.estimates[name]) == []
