"""sink_simulator: a serial port that behaves as a CC2530 with Z-Stack does, with a world or a bag behind it.

It publishes where the targets really are, in the time at which the port says so, so that a run over the radio can be
scored; and the table of nodes, which no sink knows.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from wsn_tracking_msgs import msg

from wsn_tracking import driven_air
from wsn_tracking.airwaves import air_epochs, on_board, recording_of
from wsn_tracking.driven_air import DrivenAir
from wsn_tracking.models.anchors import Floats
from wsn_tracking.node_parameters.serial import SinkSimulatorConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import Finished, TrackingNode, run
from wsn_tracking.nodes.health import OK, Health
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.zstack.pty_loop import PtyLoop
from wsn_tracking.zstack.pty_port import PtyPort
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.records import FeedbackRecord
from wsn_tracking.zstack.simulator import Measure, Simulator

TICK = 0.01  # [s]
AT_ONCE = 1e6  # speed that stands for none
Sample = tuple[int, Floats, float]  # stamp [ns], state [x, y, vx, vy], height [m]


class SinkSimulator(TrackingNode[SinkSimulatorConfig]):
    """Keeps the port in a thread of its own; exits with 0 some time after everything was sent."""

    def __init__(self) -> None:
        super().__init__('sink_simulator', SinkSimulatorConfig)
        config = self.config
        world = _Driven(config) if config.driven.on else _Recorded(config)
        self._epochs, self._first_ns, self._truth = world.epochs, world.first_ns, world.truth
        self._outputs = {target: self.give(Odometry, f'truth/target_{target}', qos.FED) for target in self._truth}
        if config.publish_anchors:
            table = convert.anchors_message(world.anchors, time.time_ns())
            self.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST).publish(table)
        self._awaited = {name for name in config.expected_nodes if name}
        self.create_subscription(String, 'ready', self._heard_ready, qos.LATCHED)
        self._speed = config.rate or AT_ONCE
        self._ended_at: float | None = None
        self._steady_to_stamp = time.time_ns() - time.monotonic_ns()
        self._simulator = Simulator(config, self._epochs, time.monotonic(), on_board(config.traffic.alpha))
        if isinstance(world, _Driven):
            self._simulator.measure = world.measured_by(self._simulator)
        self._stop = threading.Event()
        self._failed: Exception | None = None
        port = PtyPort(config.link)
        self._loop = PtyLoop(self._simulator, port, lambda: self._may_begin, self._stop.is_set)
        self._may_begin = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.create_timer(TICK, self._tick)
        # Last, for what follows cannot fail: a link that was made is taken away again by destroy_node alone.
        port.plug()  # here, so that a link that cannot be made is refused at start
        self._thread.start()
        self.get_logger().info(f'the sink is at {config.link} ({config.flavour}), {len(self._epochs)} epochs behind it')

    def destroy_node(self) -> None:
        """The port vanishes first."""
        self._stop.set()
        self._thread.join()
        super().destroy_node()

    def _heard_ready(self, message: String) -> None:
        self._awaited.discard(message.data)

    def _run(self) -> None:
        try:
            self._loop.run()
        except Exception as error:  # noqa: BLE001 (is raised in the node's own thread)
            self._failed = error

    def _tick(self) -> None:
        if self._failed is not None:
            raise self._failed
        self._may_begin = not self._awaited and self._matching.complete()
        self._tell_truth()
        self._tell_heard()
        self._end()

    def _tell_truth(self) -> None:
        """Up to the first sample after the epoch that was sent last, so that whoever interpolates holds both."""
        if self._loop.begun is None or not self._simulator.sent:
            return
        epoch = self._epochs[len(self._simulator.sent) - 1]
        for target, track in self._truth.items():
            for state_ns, state, height in track.up_to(self._first_ns + round(epoch.time_s * 1e9)):
                state[2:] *= self._speed
                self._outputs[target].publish(convert.truth_message(target, self._stamp(state_ns), state, height))

    def _stamp(self, ns: int) -> int:
        """The stamp of an instant of the recording: when the port says it."""
        begun = round((self._loop.begun or 0.0) * 1e9) + self._steady_to_stamp
        return begun + round((ns - self._first_ns) / self._speed)

    def _tell_heard(self) -> None:
        if self.config.driven.on:  # the robot hears it
            return
        told = self._simulator.told
        while told:
            _, dst, record = told.popleft()
            kind = 'position feedback' if isinstance(record, FeedbackRecord) else 'sensing command'
            self.get_logger().info(f'{kind} to {dst:#06x}: {record}', throttle_duration_sec=1.0)

    def _end(self) -> None:
        if not self._loop.finished:
            return
        now = time.monotonic()
        if self._ended_at is None:
            self._ended_at = now
            self.ended = True
            counted = ', '.join(f'{name} {n}' for name, n in self._simulator.counters.items())
            self.get_logger().info(f'{len(self._epochs)} epochs sent: {counted}')
        if self.config.linger and now - self._ended_at > self.config.linger:
            self.report()
            raise Finished

    def health(self) -> Health:
        """What it waits for."""
        if self._loop.begun is not None:
            return Health(OK, f'{len(self._simulator.sent)} of {len(self._epochs)} epochs sent')
        if self._awaited or not self._matching.complete():
            return Health(OK, f'waits for {sorted(self._awaited)} {self._matching.missing()}')
        return Health(OK, 'waits for a host to register its endpoint')

    def state(self) -> Mapping[str, Any]:
        """What went over the line, and what went wrong."""
        simulator = self._simulator
        struck = {f'fault.{type(fault).__name__}': fault.strikes for fault in simulator.faults}
        return {**simulator.counters, **simulator.device.chip.counters, **struck, 'lost bytes': self._loop.lost_bytes}


class _Recorded:
    """A recording behind the sink."""

    def __init__(self, config: SinkSimulatorConfig) -> None:
        recording = recording_of(config.scenario, config.bag, config.seed, config.target_id)
        self.anchors, self.epochs = recording.anchors, air_epochs(recording)
        self.first_ns = min((m.stamp_ns for m in recording.messages), default=0)
        self.truth: Mapping[int, Track] = {i: _Samples(truth) for i, truth in sorted(recording.truth.items())}


class _Driven:
    """Two robots behind it, of which one drives by what the sink is told."""

    def __init__(self, config: SinkSimulatorConfig) -> None:
        self._air = DrivenAir(config.driven, config.seed, config.rate)
        self.anchors, self.epochs, self.first_ns = self._air.anchors, self._air.epochs, 0
        self.truth: Mapping[int, Track] = {i: _Live(samples) for i, samples in self._air.samples.items()}

    def measured_by(self, simulator: Simulator) -> Measure:
        """In the thread of the sink, which hears the host as well."""

        def measure(epoch: AirEpoch, now: float) -> AirEpoch:
            told = [simulator.told.popleft() for _ in range(len(simulator.told))]
            return self._air.measure(epoch, now, told)

        return measure


class Track(Protocol):
    """Where a target really is."""

    def up_to(self, ns: int) -> list[Sample]:
        """The samples that were not given yet, up to the first one after `ns`."""


class _Live:
    """Samples that are made in the thread of the sink, given out once each."""

    def __init__(self, samples: deque[driven_air.Sample]) -> None:
        self._samples = samples

    def up_to(self, ns: int) -> list[Sample]:
        made = [self._samples.popleft() for _ in range(len(self._samples))]
        return [(round(t * 1e9), np.array(state), 0.0) for t, state in made]


class _Samples:
    """The samples of one target, given out once each."""

    def __init__(self, truth: Truth) -> None:
        self._stamps = truth.stamps_ns.tolist()
        self._positions, self._velocities = truth.positions, truth.velocities
        self._next = 0

    def up_to(self, ns: int) -> list[Sample]:
        """Those that were not given yet, up to the first one after `ns`; the last is held for a while longer."""
        given = []
        while self._next < len(self._stamps) and (self._next == 0 or self._stamps[self._next - 1] <= ns):
            given.append(self._sample(self._next, self._stamps[self._next]))
            self._next += 1
        if self._next == len(self._stamps) and self._stamps and self._stamps[-1] <= ns:
            given.append(self._sample(self._next - 1, self._stamps[-1] + 1_000_000_000))
            self._next += 1
        return given

    def _sample(self, at: int, ns: int) -> Sample:
        position, velocity = self._positions[at], self._velocities[at]
        return ns, np.array([*position[:2], *velocity[:2]]), float(position[2])


def main() -> None:
    """Run the node."""
    run(SinkSimulator)
