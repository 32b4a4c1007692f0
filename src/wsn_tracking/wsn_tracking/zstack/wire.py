"""The wire between a simulated sink and its host: a speed, and whatever goes wrong on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from wsn_tracking.zstack.faults import Fault, Write

BITS = 10  # of the line for a byte
At = Callable[[float, Callable[[], None]], None]


class Wire:
    """Hands on what is written, in its order, each piece at its time; `at` puts down what is to be done later."""

    def __init__(self, faults: Sequence[Fault], baud: int, at: At, put: Callable[[bytes], None]) -> None:
        self._faults = faults
        self._baud = baud
        self._at = at
        self._put = put
        self._free = 0.0  # when the line will be

    def write(self, data: bytes, now: float) -> None:
        """Bytes that belong together."""
        writes = [Write(data)]
        for fault in self._faults:
            writes = [struck for each in writes for struck in fault.line(each)]
        self._send(writes, now)

    def flush(self, now: float) -> None:
        """The line has been quiet."""
        self._send([write for fault in self._faults for write in fault.flush()], now)

    def clear(self) -> None:
        """The line is cut: nothing is underway any more."""
        self._free = 0.0

    def _send(self, writes: Sequence[Write], now: float) -> None:
        for data, pause in writes:
            begin = max(now, self._free)
            self._free = begin + pause + (len(data) * BITS / self._baud if self._baud else 0.0)
            if begin <= now:
                self._put(data)
            else:
                self._at(begin, lambda data=data: self._put(data))  # type: ignore[misc]
