"""A graph over two hosts, by root alone: `python -m wsn_tracking.studies.live_hosts -o docs/results`.

Each host is a network namespace with a shared memory of its own, and a cable leads from one to the other. Nodes find
each other as they do by default.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from wsn_tracking import graphs, processes
from wsn_tracking.bags.estimates import differences, read_estimates
from wsn_tracking.errors import TrackingError
from wsn_tracking.offline import offline
from wsn_tracking.studies.results import Result, Studies, call
from wsn_tracking.trackers.estimate import Estimate

BAG = 'bags/a_loop'
FAR = {'estimator_2', 'estimator_3', 'evaluator'}  # on the second host; the feed, sensing and the recorder on the first
OUTPUTS = [f'{kind}_{i}' for kind in ('local', 'fused') for i in (1, 2, 3)]
REPEATS = 20
PATIENCE_S = 120.0
DEVICE = 'cable'


def hosts(repeats: int = REPEATS) -> Result:
    """System A over two hosts against the evaluator: how many estimates differ in any bit."""
    source, recording = graphs.open_bag(BAG)
    run = offline(source, recording)
    compared, differing = 0, 0
    with two_hosts() as within:
        for _ in range(repeats):
            published = _replayed(within)
            compared += sum(map(len, published.values()))
            differing += sum(len(differences(published.get(name, ()), run.estimates[name])) for name in OUTPUTS)
    return {'repeats': repeats, 'compared': compared, 'differing': differing}


@contextmanager
def two_hosts() -> Iterator[tuple[list[str], list[str]]]:
    """What starts a command on the one and on the other; TrackingError where they cannot be made."""
    names = [f'wsn{os.getpid()}{end}' for end in 'ab']
    with ExitStack() as stack:
        for name in names:
            _ip('netns', 'add', name)
            stack.callback(_ip, 'netns', 'delete', name)
        _ip('link', 'add', DEVICE, 'netns', names[0], 'type', 'veth', 'peer', 'name', DEVICE, 'netns', names[1])
        within = []
        for number, name in enumerate(names, 1):
            _ip('-n', name, 'address', 'add', f'10.77.0.{number}/24', 'dev', DEVICE)
            for device in ('lo', DEVICE):
                _ip('-n', name, 'link', 'set', device, 'up')
            hold = 'mount -t tmpfs none /dev/shm && echo there && exec sleep infinity'
            words = ['ip', 'netns', 'exec', name, 'unshare', '--mount', 'sh', '-c', hold]
            holder = stack.enter_context(processes.ended(words))
            assert holder.stdout is not None
            if holder.stdout.readline() != 'there\n':
                raise TrackingError('no shared memory can be mounted for a host: that takes root')
            within.append(['nsenter', f'--target={holder.pid}', '--mount', '--net'])
        yield within[0], within[1]


def _ip(*words: str) -> None:
    program = shutil.which('ip')
    if program is None:
        raise TrackingError('there is no `ip`: install iproute2')
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise TrackingError(f'no network of two hosts can be made ({done.stderr.strip()}): that takes root')


def _replayed(within: tuple[list[str], list[str]]) -> dict[str, list[Estimate]]:
    environment = {name: value for name, value in os.environ.items() if name != 'ROS_AUTOMATIC_DISCOVERY_RANGE'}
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        out = Path(folder, 'out')
        record = {'output': str(out), 'extra_topics': [f'estimate/{name}' for name in OUTPUTS]}
        running = {}
        for process in graphs.replay(BAG, rate=0.0, record=record):
            command = processes.command(process, processes.write_parameters(process, Path(folder)))
            words = [*within[process.name in FAR], *command]
            running[process.name] = stack.enter_context(
                processes.ended(words, env=environment, stderr=subprocess.DEVNULL)
            )
        running['bag_recorder'].wait(PATIENCE_S)
        return read_estimates(out)


STUDIES: Studies = {'hosts': {'hosts': hosts}}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    return call('wsn_tracking.studies.live_hosts', 'Run a graph over two hosts.', STUDIES, arguments)


if __name__ == '__main__':
    sys.exit(main())
