"""Nodes: from publish to callback, and from start to ready; both in processes of their own."""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Iterable

from wsn_tracking.benchmarks.graph import private
from wsn_tracking.benchmarks.rows import Row, Sizes, at_most
from wsn_tracking.errors import TrackingError

GROUP = 'nodes'
ENTITIES = 150  # subscriptions, as 50 nodes in a process have them
MODULES = 'wsn_tracking.nodes'


def rows(sizes: Sizes) -> Iterable[Row]:
    """The draining executor against the stock one, an estimator against a bare node."""
    try:
        yield from _latency(sizes)
        yield from _start(sizes)
    except (OSError, TrackingError, subprocess.SubprocessError) as error:
        yield Row(GROUP, 'publish to callback, ready after start', '', None, note=' '.join(str(error).split()))


def _latency(sizes: Sizes) -> Iterable[Row]:
    found: dict[str, list[float]] = {'draining': [], 'stock': []}
    for _ in range(3):
        for kind, values in found.items():
            values.append(_numbers(f'{MODULES}.benchmark_latency', kind, str(ENTITIES), str(sizes.latencies))[0])
    ours, theirs = (statistics.median(values) for values in found.values())
    work = f'publish to callback beside {ENTITIES} subscriptions, median'
    yield Row(GROUP, work, 'ms', ours, 'stock executor', theirs, at_most(1.0))


def _start(sizes: Sizes) -> Iterable[Row]:
    words = {
        'ours': [*_started('estimator_node', 'main'), '--ros-args', '-p', 'input:=range'],
        'bare': _started('benchmark_start', 'bare'),
    }
    wall: dict[str, list[float]] = {name: [] for name in words}
    cpu: dict[str, list[float]] = {name: [] for name in words}
    for _ in range(sizes.starts):
        for name, command in words.items():
            seconds, busy = _numbers(f'{MODULES}.benchmark_start', *command)
            wall[name].append(seconds)
            cpu[name].append(busy)
    work = 'estimator_node until it is ready'
    for kind, took, goal in (('CPU s', cpu, at_most(1.3, ratio=True)), ('s', wall, None)):
        ours, theirs = (statistics.median(took[name]) for name in words)
        yield Row(GROUP, work, kind, ours, 'bare rclpy node', theirs, goal, faster_is_more=False)


def _started(module: str, function: str) -> list[str]:
    """Both alike: how an executable finds its entry point takes its own time, whatever the node."""
    return [sys.executable, '-c', f'from {MODULES}.{module} import {function}; {function}()']


def _numbers(module: str, *words: str) -> list[float]:
    """What a module prints last when it is run; the middleware may have complained before."""
    done = subprocess.run(
        [sys.executable, '-m', module, *words],
        env=private(),
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
    )
    if done.returncode:
        raise TrackingError(f'{module} ended with code {done.returncode}: {done.stderr[-300:]}')
    return [float(word) for word in done.stdout.splitlines()[-1].split()]
