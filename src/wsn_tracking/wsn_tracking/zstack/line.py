"""The line: waits for bytes, has them turned into items, and measures its pauses.

Whether a frame was broken off shows in a pause of the line. A host that was held up sees one that never was: what came
meanwhile lies ready. So only time during which the line was watched and stayed empty counts.
"""

from __future__ import annotations

import contextlib
import os
import select
import time
from typing import NamedTuple

from wsn_tracking.zstack.commands import Command, encode
from wsn_tracking.zstack.frames import encode_frame
from wsn_tracking.zstack.port import Port
from wsn_tracking.zstack.protocols import Item, LineProtocol

LOOKS = 5  # at the line within one gap
MOST_STALE = 1 << 20  # bytes; no port holds more


class Heard(NamedTuple):
    """Items that became complete, and when the bytes were read, host clock (monotonic) [ns]."""

    items: list[Item]
    arrival_ns: int


class Bell:
    """Wakes a thread that waits for the line."""

    def __init__(self) -> None:
        self._ear, self._hand = os.pipe()
        os.set_blocking(self._ear, False)
        os.set_blocking(self._hand, False)

    def fileno(self) -> int:
        """For `select`."""
        return self._ear

    def ring(self) -> None:
        """Wake, now or at the next waiting."""
        with contextlib.suppress(BlockingIOError):  # then it has been rung often enough
            os.write(self._hand, b'!')

    def hush(self) -> None:
        """Forget what was rung."""
        with contextlib.suppress(BlockingIOError):
            os.read(self._ear, 65536)

    def close(self) -> None:
        """No more."""
        os.close(self._ear)
        os.close(self._hand)


class Line:
    """An open port and the protocol on it."""

    def __init__(self, port: Port, protocol: LineProtocol, gap_s: float, bell: Bell | None = None) -> None:
        self.port = port
        self._protocol = protocol
        self._look_s = gap_s / LOOKS
        self._bell = bell
        self._quiet_s = 0.0

    def hear(self, until: float) -> Heard:
        """Wait until there are bytes, the bell rings, or it is `until` (time.monotonic)."""
        left = max(until - time.monotonic(), 0.0)
        watching = self._protocol.held > 0 and left >= self._look_s
        sources: list[Port | Bell] = [self.port] if self._bell is None else [self.port, self._bell]
        ready, _, _ = select.select(sources, [], [], self._look_s if watching else left)
        arrival_ns = time.monotonic_ns()
        if self._bell in ready and self._bell is not None:
            self._bell.hush()
        if self.port in ready:
            return Heard(self._protocol.feed(self.port.read(), self._quiet_s), arrival_ns)
        if watching and not ready:
            self._quiet_s += self._look_s
            return Heard(self._protocol.feed(b'', self._quiet_s), arrival_ns)
        return Heard([], arrival_ns)

    def drop(self) -> int:
        """Discard what lies ready; how many bytes that were. A line that does not stop is left as it is."""
        dropped = 0
        while dropped < MOST_STALE and select.select([self.port], [], [], 0)[0]:
            data = self.port.read()
            if not data:
                break
            dropped += len(data)
        return dropped

    def say(self, command: Command) -> None:
        """Send a command."""
        self.port.write(encode_frame(encode(command)))
