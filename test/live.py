"""What tests of running graphs share: graphs in domains of their own, and what they published."""

from __future__ import annotations

import contextlib
import os
import subprocess
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

from domain_coordinator import domain_id

from wsn_tracking import processes
from wsn_tracking.graphs import Process

ROOT = Path(__file__).resolve().parents[1]
A_LOOP = ROOT / 'bags' / 'a_loop'
ENDS_IN_S = 10.0  # far beyond what a node takes that is asked to end
TIMEOUT = 180.0  # [s] far beyond what a short graph takes on a machine that does much else
TIMEOUTS = ('output_timeout', 'ready_timeout', 'loss_timeout', 'fusion_timeout', 'round_timeout')
PATIENT = dict.fromkeys(TIMEOUTS, TIMEOUT)  # settings of a replay that no busy machine changes


@contextlib.contextmanager
def private_domain() -> Iterator[dict[str, str]]:
    """An environment whose nodes see nobody else's."""
    with domain_id() as domain:
        yield {**os.environ, 'ROS_DOMAIN_ID': str(domain), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


@contextlib.contextmanager
def started(graph: Sequence[Process], environment: Mapping[str, str]) -> Iterator[dict[str, subprocess.Popen[str]]]:
    """The processes of a graph, by name; whatever still runs at the end is killed."""
    with tempfile.TemporaryDirectory() as folder:
        running = {}
        try:
            for process in graph:
                running[process.name] = start(process, environment, Path(folder))
            yield running
        finally:
            end(running.values())


def end(processes: Collection[subprocess.Popen[str]]) -> None:
    """Ask first: the middleware's shared memory outlives processes that are killed, and disturbs those that follow."""
    for process in processes:
        process.terminate()
    for process in processes:
        try:
            process.communicate(timeout=ENDS_IN_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def start(process: Process, environment: Mapping[str, str], folder: Path) -> subprocess.Popen[str]:
    """One process of a graph, its output piped."""
    return subprocess.Popen(
        processes.command(process, processes.write_parameters(process, folder)),
        env=dict(environment),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def wait_all(running: Mapping[str, subprocess.Popen[str]], names: Sequence[str], timeout: float) -> dict[str, str]:
    """Outputs of processes that end by themselves with code 0."""
    outputs = {}
    for name in names:
        output, _ = running[name].communicate(timeout=timeout)
        assert running[name].returncode == 0, f'{name} ended with {running[name].returncode}:\n{output}'
        outputs[name] = output
    return outputs


def all_run(running: Mapping[str, subprocess.Popen[str]]) -> bool:
    """That nobody has ended yet; whoever waits for a graph need not wait for one that has failed."""
    for name, process in running.items():
        assert process.poll() is None, f'{name} has ended with {process.returncode}:\n{process.communicate()[0]}'
    return True
