"""Start the processes of a graph from a plain shell, and end them again."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from wsn_tracking.configuration import is_of_ros
from wsn_tracking.errors import TrackingError
from wsn_tracking.graphs import Process
from wsn_tracking.lifeline import tied
from wsn_tracking.node_parameters.common import NodeConfig
from wsn_tracking.node_parameters.executables import EXECUTABLES
from wsn_tracking.parameters import Values, build, specs
from wsn_tracking.ros_yaml import dump

GRACE = 5.0  # [s] a process may take to end when it is asked to
FAREWELL = 2.0 * GRACE  # [s] from the failure of a feed until whoever waits for it is ended
POLL = 0.05  # [s]
FEEDS = ('bag_player', 'world')


def command(process: Process, parameters: Path) -> list[str]:
    """What starts a process as `ros2 run` would, with a parameter file of its own."""
    return [
        str(executable(process.executable)),
        '--ros-args',
        '-r',
        f'__node:={process.name}',
        '--params-file',
        str(parameters),
    ]


def executable(name: str) -> Path:
    """The installed executable of that name."""
    for prefix in filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)):
        path = Path(prefix, 'lib', 'wsn_tracking', name)
        if path.is_file():
            return path
    raise TrackingError(f'{name} is not installed: build the workspace and source its setup file (`. ./env`)')


def declared(process: Process) -> Values:
    """The parameters that the executable knows, of all that a configuration gives; TrackingError for a wrong value."""
    kinds = (EXECUTABLES[process.executable], NodeConfig)
    for kind in kinds:
        build(kind, process.parameters)  # a node that refuses it would be waited for
    known = {spec.name for kind in kinds for spec in specs(kind)}
    return {k: v for k, v in process.parameters.items() if k in known or is_of_ros(k)}


def write_parameters(process: Process, folder: Path) -> Path:
    """A ROS 2 parameter file for one process."""
    path = folder / f'{process.name}.yaml'
    values = {name: _plain(value) for name, value in declared(process).items()}
    content = {'/**': {'ros__parameters': {k: v for k, v in values.items() if v != []}}}
    path.write_text(dump(content), 'utf-8')
    return path


def run_graph(processes: Sequence[Process], last: Sequence[str]) -> int:
    """Start all, wait until those named in `last` have ended, end the others; the worst exit code.

    A process that ends on its own with an error is named; the graph goes on without it.
    """
    running: dict[str, subprocess.Popen[bytes]] = {}
    with _requests_to_end() as asked, tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        try:
            commands = {
                process.name: command(process, write_parameters(process, Path(folder))) for process in processes
            }
            for name, words in commands.items():
                if not asked:
                    running[name] = _start(words)
            code = _wait(running, last, asked)
        finally:
            _end(running)
    if asked:
        raise KeyboardInterrupt
    return code


@contextmanager
def started(graph: Sequence[Process], folder: Path) -> Iterator[dict[str, subprocess.Popen[str]]]:
    """The processes of a graph, by name, with parameter files in a folder; none outlives its use."""
    with ExitStack() as stack:
        yield {
            process.name: stack.enter_context(
                ended(command(process, write_parameters(process, folder)), stderr=subprocess.DEVNULL)
            )
            for process in graph
        }


@contextmanager
def ended(words: Sequence[str], **options: Any) -> Iterator[subprocess.Popen[str]]:
    """A process that does not outlive its use."""
    process = subprocess.Popen(words, text=True, stdout=subprocess.PIPE, **options)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def cpu_seconds(pid: int) -> float:
    """CPU time that a running process has taken so far (Linux)."""
    fields = Path(f'/proc/{pid}/stat').read_text('ascii').rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


@contextmanager
def _requests_to_end() -> Iterator[Sequence[int]]:
    """The signals that came meanwhile; none breaks into the start or the end of a process, and leaves it behind.

    What the caller ignores stays ignored, as under nohup.
    """
    asked: list[int] = []
    if threading.current_thread() is not threading.main_thread():  # signals are the main thread's alone
        yield asked
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    heard = [number for number, handler in before.items() if handler not in {signal.SIG_IGN, None}]
    for number in heard:
        signal.signal(number, lambda number, _: asked.append(number))
    try:
        yield asked
    finally:
        for number in heard:
            signal.signal(number, before[number])


def _start(words: Sequence[str]) -> subprocess.Popen[bytes]:
    try:
        # a session of its own: the shell's Ctrl-C reaches this program alone, which then ends all in order
        return subprocess.Popen(words, start_new_session=True, env=tied(os.environ))
    except OSError as error:
        raise TrackingError(f'{words[0]} cannot be started ({error.strerror}): build the workspace anew') from error


def _wait(running: Mapping[str, subprocess.Popen[bytes]], last: Sequence[str], asked: Sequence[int]) -> int:
    codes: dict[str, int] = {}
    given_up = math.inf
    while not (codes.keys() >= set(last) or asked) and time.monotonic() < given_up:
        time.sleep(POLL)
        for name, process in running.items():
            code = process.poll()
            if code is None or name in codes:
                continue
            codes[name] = code
            if code:
                print(f'{name} ended with code {code}', file=sys.stderr)
                if name in FEEDS:  # nothing will come any more: whoever waits for it gets a grace
                    given_up = time.monotonic() + FAREWELL
    return max((abs(code) for code in codes.values()), default=1)


def _end(running: Mapping[str, subprocess.Popen[bytes]]) -> None:
    alive = [process for process in running.values() if process.poll() is None]
    for process in alive:
        process.terminate()  # a node that is still being imported tells of SIGINT at length
    deadline = time.monotonic() + GRACE
    for process in alive:
        try:
            process.wait(max(deadline - time.monotonic(), 0.1))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
