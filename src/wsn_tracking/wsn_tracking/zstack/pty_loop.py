"""A simulated sink behind a pseudo terminal, in real time."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from wsn_tracking.zstack.outlet import Plug
from wsn_tracking.zstack.pty_port import PtyPort
from wsn_tracking.zstack.simulator import Simulator

LONGEST_WAIT_S = 0.05  # between two looks at whether to begin, or to stop
WAITING_BYTES = 1 << 20  # for a host that does not read; beyond, the oldest are lost


class PtyLoop:
    """Runs in one thread until `stop()`; `may_begin` says when the world may begin, as soon as messages are wanted."""

    def __init__(
        self,
        simulator: Simulator,
        port: PtyPort,
        may_begin: Callable[[], bool] = lambda: True,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        self.simulator = simulator
        self.lost_bytes = 0
        self.begun: float | None = None  # when the world began (time.monotonic)
        self._idle = False  # as it was before the host was heard, which may ask something in every turn
        self._port = port
        self._may_begin = may_begin
        self._stop = stop
        self._waiting: deque[bytes] = deque()
        self._size = 0

    @property
    def finished(self) -> bool:
        """Whether everything was sent."""
        return self.begun is not None and self._idle and not self.simulator.to_come

    def run(self) -> None:
        """Until told to stop; the port is gone then."""
        try:
            while not self._stop():
                self.turn()
        finally:
            self._port.unplug()

    def turn(self) -> None:
        """One wait, and whatever comes of it."""
        now, self._idle = time.monotonic(), False
        for action in self.simulator.poll(now):
            self._do(action)
        self._write()
        self._idle = self.simulator.finished and not self._waiting
        if self.begun is None and self.simulator.delivers and self._may_begin():
            self.begun = time.monotonic()
            self.simulator.begin(self.begun)
        wait = min(max(self.simulator.due - time.monotonic(), 0.0), LONGEST_WAIT_S)
        self._port.wait(wait, writable=bool(self._waiting))
        if self._port.plugged:
            data = self._port.read()
            if data:
                self.simulator.hear(data, time.monotonic())

    def _do(self, action: bytes | Plug) -> None:
        if isinstance(action, bytes):
            self._waiting.append(action)
            self._size += len(action)
            return
        self._write()  # what was said before the plug was pulled
        self._waiting.clear()
        self._size = 0
        if action is Plug.OUT:
            self._port.unplug(reserve=True)
        else:
            self._port.plug()

    def _write(self) -> None:
        """What the line takes; each write alone, so that what is written in pieces may be read in pieces."""
        while self._waiting:
            data = self._waiting.popleft()
            taken = self._port.write(data) if self._port.plugged else len(data)
            self._size -= taken
            if taken < len(data):
                self._waiting.appendleft(data[taken:])
                break
        while self._size > WAITING_BYTES:
            lost = len(self._waiting.popleft())
            self._size -= lost
            self.lost_bytes += lost
