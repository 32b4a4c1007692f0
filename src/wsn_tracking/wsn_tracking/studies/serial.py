"""The graph behind a serial line, end to end: `python -m wsn_tracking.studies.serial -o docs/results`.

A simulated sink says what twelve nodes measure onto a pseudo terminal; serial_bridge_node, sensing and estimators run
as processes of their own; one more process notes when measurements arrive.
"""

from __future__ import annotations

import json
import random
import select
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wsn_tracking import graphs, processes
from wsn_tracking.airwaves import air_epochs
from wsn_tracking.errors import TrackingError
from wsn_tracking.parameters import Values
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.sink_thread import SinkThread
from wsn_tracking.studies.live_graph import alone
from wsn_tracking.studies.results import Result, Studies, call
from wsn_tracking.zstack.commands import decode
from wsn_tracking.zstack.motes import Message
from wsn_tracking.zstack.parser import Parser
from wsn_tracking.zstack.payload import MAX_RECORDS, PayloadType
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.simulator_settings import SimulatorConfig

HERTZ, SECONDS = 10.0, 60.0
ESTIMATORS = 3
RANDOM_BYTES = 10_000_000
PATIENCE = 60.0  # [s] until all processes are ready, and after the end
LISTENER = 'wsn_tracking.nodes.benchmark_serial'
FAULTLESS = (  # counters of the bridge that are told; all are 0 where nothing is lost
    *('garbage_bytes', 'bad_fcs', 'gaps', 'lost', 'resets', 'host_queue_dropped', 'duplicates', 'lost_messages'),
    *('late_messages', 'node_restarts', 'clock_strange', 'lqi_unreachable', 'after_epoch_end'),
)


def watched(graph: Sequence[graphs.Process], topics: Sequence[str]) -> tuple[graphs.Process, ...]:
    """The graph, each of whose publishers waits for one more subscriber of these topics before it is ready."""
    return tuple(process._replace(parameters=_watched(process, topics)) for process in graph)


def _watched(process: graphs.Process, topics: Sequence[str]) -> Values:
    given = dict(entry.split('=') for entry in process.parameters['expected_subscribers'] if entry)
    given.update({topic: int(given.get(topic, 0)) + 1 for topic in topics if topic in process.gives})
    return {**process.parameters, 'expected_subscribers': [f'{k}={n}' for k, n in given.items()] or ['']}


class Heard(NamedTuple):
    """What became of a run."""

    said: Mapping[tuple[int, int], int]  # (node, seq) of each measurement -> when its bytes were written [ns]
    arrived: Sequence[tuple[int, int, int]]  # node, seq, when [ns]
    estimates: Mapping[str, Sequence[tuple[int, int]]]  # by output: contributors and measurements of each
    counters: Mapping[str, int]
    busy: float  # share of a core that the bridge took


def world(seconds: float) -> list[AirEpoch]:
    """The loop of scenario L again and again, at 10 Hz."""
    loop = scenario('a_loop')
    truth = np.resize(loop.truth, (round(HERTZ * seconds), 4))
    return air_epochs(record(loop._replace(period=1.0 / HERTZ, truth=truth), 1))


def listen(seconds: float, settings: Values | None = None) -> Heard:
    """Run the graph on that world; every measurement is passed on by the sensing nodes."""
    epochs = world(seconds)
    count = sum(len(epoch.readings) for epoch in epochs)
    with tempfile.TemporaryDirectory(prefix='wsn_tracking_') as folder:
        link, file = Path(folder, 'sink'), Path(folder, 'heard.json')
        given = {'port': str(link), 'period': 1.0 / HERTZ, 'trigger.kind': 'always', **(settings or {})}
        graph = graphs.serial(settings=given)
        outputs = [f'{kind}_{i}' for kind in ('local', 'fused') for i in range(1, ESTIMATORS + 1)]
        graph = watched(graph, ['rssi', *(f'estimate/{output}' for output in outputs)])
        sink = SinkThread(SimulatorConfig(link=str(link)), epochs)
        said: dict[tuple[int, int], int] = {}

        def note(message: Message, given: bool) -> None:
            payload = message.payload
            if payload.type == PayloadType.RSSI:
                said[payload.node_id, (payload.seq or 0) * MAX_RECORDS] = time.monotonic_ns()

        sink.simulator.witness = note
        names = ','.join(process.name for process in graph)
        words = [sys.executable, '-m', LISTENER, str(file), names, ','.join(outputs), str(count), str(len(epochs))]
        with sink.running(), processes.started(graph, Path(folder)) as running, processes.ended(words) as listener:
            _await_ready(listener)
            bridge = running[graphs.BRIDGE].pid
            before, began = processes.cpu_seconds(bridge), time.monotonic()
            sink.may_begin.set()
            listener.wait(seconds + PATIENCE)
            busy = (processes.cpu_seconds(bridge) - before) / (time.monotonic() - began)
        told = json.loads(file.read_text('utf-8'))
    return Heard(said, [tuple(entry) for entry in told['rssi']], told['estimates'], told['counters'], busy)


def _await_ready(listener: subprocess.Popen[str]) -> None:
    assert listener.stdout is not None
    said = select.select([listener.stdout], [], [], PATIENCE)[0]
    if not said or listener.stdout.readline().strip() != 'ready':
        raise TrackingError('the graph behind the serial line did not become ready: start its nodes alone to see why')


def end_to_end(seconds: float = SECONDS, settings: Values | None = None) -> Result:
    """12 nodes at 10 Hz on a serial line for a minute: what arrives, after how long, and what the bridge takes."""
    heard = listen(seconds, settings)
    arrived = {(node, seq): when for node, seq, when in heard.arrived}
    latencies = sorted((arrived[key] - when) * 1e-6 for key, when in heard.said.items() if key in arrived)
    return {
        'epochs': round(HERTZ * seconds),
        'said': len(heard.said),
        'arrived': len(heard.arrived),
        'lost': len(heard.said.keys() - arrived.keys()),
        'estimates': {name: len(each) for name, each in sorted(heard.estimates.items())},
        'measurements_used': {name: sum(n for _, n in each) for name, each in sorted(heard.estimates.items())},
        'fused_from_fewer_than_3': sum(
            n < ESTIMATORS for k, e in heard.estimates.items() if 'fused' in k for n, _ in e
        ),
        'faults': {name: n for name in FAULTLESS if (n := heard.counters.get(name, 0))},
        'byte_to_measurement_ms': {
            'median': round(statistics.median(latencies), 2),
            '95_percent': round(latencies[int(0.95 * len(latencies))], 2),
            'longest': round(latencies[-1], 1),
        },
        'bridge_share_of_a_core': round(heard.busy, 3),
    }


def noise(count: int = RANDOM_BYTES) -> Result:
    """Ten million random bytes into the parser, and every frame that is found by chance decoded."""
    draw, parser, held = random.Random(7), Parser(), 0
    for _ in range(count // 10_000):
        for frame in parser.feed(draw.randbytes(10_000), 0.0):
            decode(frame)
        held = max(held, parser.held)
    return {'bytes': count, 'frames_by_chance': parser.counters['frames'], 'most_held_bytes': held}


STUDIES: Studies = {'serial': {'end_to_end': end_to_end, 'noise': noise}}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; the exit status."""
    alone()
    return call('wsn_tracking.studies.serial', 'Run the long runs of the serial line.', STUDIES, arguments)


if __name__ == '__main__':
    sys.exit(main())
