"""A simulated sink in a thread of its own, for programs that do something else meanwhile."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from wsn_tracking.zstack.on_board import Judge, in_radius
from wsn_tracking.zstack.pty_loop import PtyLoop
from wsn_tracking.zstack.pty_port import PtyPort
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.simulator import Simulator
from wsn_tracking.zstack.simulator_settings import SimulatorConfig

LONGEST_S = 60.0  # that a job may wait for its turn
T = TypeVar('T')


class SinkThread:
    """The sink is at its link within `with sink.running()`; its world begins when `may_begin` is set."""

    def __init__(self, config: SimulatorConfig, world: Sequence[AirEpoch], on_board: Judge = in_radius) -> None:
        self.simulator = Simulator(config, world, time.monotonic(), on_board)
        self.may_begin = threading.Event()
        self.port = PtyPort(config.link)
        self.loop = PtyLoop(self.simulator, self.port, self.may_begin.is_set, self._turn)
        self._jobs: queue.SimpleQueue[Callable[[float], None]] = queue.SimpleQueue()
        self._ended = threading.Event()

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Plugged in; the port is gone afterwards."""
        thread = threading.Thread(target=self.loop.run, name='simulated sink', daemon=True)
        self.port.plug()
        thread.start()
        try:
            yield
        finally:
            self._ended.set()
            thread.join()

    def do(self, job: Callable[[Simulator, float], T]) -> T:
        """Have something done between two turns of the sink, given the time; what that gives."""
        done: queue.SimpleQueue[T] = queue.SimpleQueue()
        self._jobs.put(lambda now: done.put(job(self.simulator, now)))
        return done.get(timeout=LONGEST_S)

    def _turn(self) -> bool:
        while not self._jobs.empty():
            self._jobs.get()(time.monotonic())
        return self._ended.is_set()
