"""The live graph as real processes: how many ranges a second it bears, and how fast it goes at full speed."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from wsn_tracking import graphs, processes
from wsn_tracking.bags.save import save
from wsn_tracking.benchmarks.bags import loop
from wsn_tracking.benchmarks.rows import Row, Sizes, at_least
from wsn_tracking.errors import TrackingError
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario

GROUP = 'graph'
NODES, HERTZ = 12, 10.0
BEHIND = 64  # epochs that the outputs may be behind the feed (their messages fit every queue): more, and it has to wait
SAMPLED_EVERY = 0.25  # [s]
LOAD = 2400.0  # [ranges/s]
SENT = re.compile(r'sent (\d+) epochs in ([\d.]+) s \(([\d.]+) x real time\)')


class Played(NamedTuple):
    """What the feed of a graph says at its end."""

    epochs: int
    seconds: float
    speed: float  # times real time
    share: float | None = None  # of a core, that a process took which was watched


def play(graph: Sequence[graphs.Process], timeout: float = 120.0, watch: str = '') -> Played:
    """Run a graph until its feed ends; TrackingError where the feed, or before it any other process, fails.

    watch: name of a process whose CPU time is sampled meanwhile.
    """
    running: dict[str, subprocess.Popen[str]] = {}
    feed = next(p.name for p in graph if p.name in processes.FEEDS)
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        try:
            for process in graph:
                running[process.name] = _start(process, Path(folder))
            samples = list(_watched(running[feed], running[watch])) if watch else []
            said, _ = running[feed].communicate(timeout=timeout)
            failed = {name: p.returncode for name, p in running.items() if p.poll()}
        except subprocess.TimeoutExpired:
            raise TrackingError(f'{feed} has not ended after {timeout:g} s: the graph has lost something') from None
        finally:
            _end(running.values())
    found = SENT.search(said)
    if found is None or failed:
        raise TrackingError(f'the graph failed ({failed or feed}): {said[-500:]}')
    return Played(int(found[1]), float(found[2]), float(found[3]), share_of(samples))


def _watched(feed: subprocess.Popen[str], process: subprocess.Popen[str]) -> Iterator[tuple[float, float]]:
    """Steady and CPU time of a process [s], until it or the feed ends; nothing where the system does not tell."""
    with contextlib.suppress(OSError):
        while feed.poll() is None:
            yield time.monotonic(), processes.cpu_seconds(process.pid)
            time.sleep(SAMPLED_EVERY)


def share_of(samples: Sequence[tuple[float, float]]) -> float | None:
    """Share of a core over the last two thirds, when all is started; None: too few samples."""
    steady = samples[len(samples) // 3 :]
    if len(steady) < 3:
        return None
    (t0, busy0), (t1, busy1) = steady[0], steady[-1]
    return (busy1 - busy0) / (t1 - t0)


def _start(process: graphs.Process, folder: Path) -> subprocess.Popen[str]:
    words = processes.command(process, processes.write_parameters(process, folder))
    said = subprocess.PIPE if process.name in processes.FEEDS else subprocess.DEVNULL
    return subprocess.Popen(words, env=private(), stdout=said, stderr=subprocess.STDOUT, text=True)


def private() -> Mapping[str, str]:
    """An environment whose nodes see nobody else's, as far as a number below 100 can tell."""
    return {**os.environ, 'ROS_DOMAIN_ID': str(1 + os.getpid() % 99), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}


def _end(running: Iterable[subprocess.Popen[str]]) -> None:
    for process in running:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
    for process in running:
        try:
            process.communicate(timeout=processes.GRACE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def loaded(bag: Path, ranges_per_s: float) -> tuple[graphs.Process, ...]:
    """A player at that load (0: as much as is borne), 12 sensing nodes in a process that always send, 3 estimators."""
    source, recording = graphs.open_bag(str(bag))
    plans = graphs.plans_of(source, recording.anchors, settings={'trigger.kind': 'always'})
    parameters = {'bag': str(bag), 'rate': ranges_per_s / (NODES * HERTZ), 'window': BEHIND}
    feed = graphs.Process('bag_player_node', 'bag_player', parameters)
    return graphs.complete(source, plans, feed, graphs.How(replay=True))


def rows(sizes: Sizes) -> Iterable[Row]:
    """How many ranges a second the graph bears, and the speed of scenario L at rate max."""
    work = '12 sensing nodes in a process, 3 estimators, nothing lost, backlog bounded'
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        bag, a_loop = Path(folder, 'load'), Path(folder, 'a_loop')
        save(bag, loop(1.0 / HERTZ, sizes.graph_s * LOAD / (NODES * HERTZ)))
        save(a_loop, record(scenario('a_loop'), 1))
        try:
            most = statistics.median(_borne(play(loaded(bag, 0.0))) for _ in range(sizes.rounds))
            yield Row(GROUP, work, 'ranges/s', most, goal=at_least(LOAD))
            borne = statistics.median(_borne(play(loaded(bag, LOAD))) for _ in range(sizes.rounds))
            yield Row(GROUP, f'the same, fed with {LOAD:g} a second', 'ranges/s', borne, goal=at_least(0.98 * LOAD))
            speed = statistics.median(play(graphs.replay(str(a_loop), rate=0.0)).speed for _ in range(sizes.rounds))
            yield Row(GROUP, 'a_loop at rate max, with evaluator', 'x real time', speed, goal=at_least(50.0))
        except TrackingError as error:
            yield Row(GROUP, work, 'ranges/s', None, goal=at_least(LOAD), note=' '.join(str(error).split()))


def _borne(played: Played) -> float:
    return (played.epochs - 1) * NODES / played.seconds
