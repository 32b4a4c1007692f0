"""Faults of the serial line: noise, text, frames that are damaged, broken off or written in pieces."""

from __future__ import annotations

from wsn_tracking.zstack.faults.base import Fault, Write
from wsn_tracking.zstack.frames import MAX_DATA, OVERHEAD, SOF

BOOT_TEXT = b'\r\nZ-Stack boot: CC2530 rev E, RAM ok\r\n'
BROKEN_OFF_S = 0.25  # rest of the line after a frame that ends too early
PIECE_S = 0.02  # shorter than the pause that ends a frame
MAX_GARBAGE = 24
TEXT = ord('$')


def is_frame(data: bytes) -> bool:
    """Whether the bytes are one frame."""
    return len(data) >= OVERHEAD and data[0] == SOF and len(data) == data[1] + OVERHEAD


class Garbage(Fault):
    """Noise ahead of a frame."""

    stage = 1

    def line(self, write: Write) -> list[Write]:
        """Some random bytes; whatever is in them, the frame itself is whole."""
        if not self.hits():
            return [write]
        return [Write(self.random.randbytes(self.random.randint(1, MAX_GARBAGE))), write]


class BootText(Fault):
    """Text of a boot loader, at the plug and in between."""

    stage = 1

    def line(self, write: Write) -> list[Write]:
        """The text, then what was to be said."""
        return [Write(BOOT_TEXT), write] if self.hits() else [write]

    def at_plug(self) -> bytes:
        """The text."""
        return BOOT_TEXT


class BadFcs(Fault):
    """A frame that was damaged underway: it is lost."""

    def line(self, write: Write) -> list[Write]:
        """One bit of the check is wrong; in a line of text, one digit."""
        data = write.data
        if not self.hits():
            return [write]
        if data[:1] == b'$':
            at = data.rfind(b'*') + 1
            digit = b'0' if data[at : at + 1] != b'0' else b'1'
            return [write._replace(data=data[:at] + digit + data[at + 1 :])]
        return [write._replace(data=data[:-1] + bytes((data[-1] ^ 1 << self.random.randrange(8),)))]


class CorruptedLength(Fault):
    """A frame that claims another length: it is lost, and must not take others with it."""

    def line(self, write: Write) -> list[Write]:
        """LEN is wrong, but possible."""
        data = write.data
        if not is_frame(data) or not self.hits():
            return [write]
        length = (data[1] + self.random.randint(1, MAX_DATA)) % (MAX_DATA + 1)
        return [write._replace(data=data[:1] + bytes((length,)) + data[2:])]


class LongLength(Fault):
    """What looks like the beginning of a frame of more than 250 bytes, ahead of a frame."""

    stage = 1

    def line(self, write: Write) -> list[Write]:
        """Three bytes that are no frame."""
        if not self.hits():
            return [write]
        return [Write(bytes((SOF, self.random.randint(MAX_DATA + 1, 255), 0x44))), write]


class Cut(Fault):
    """A frame that is broken off: it is lost, and a pause of the line follows."""

    def line(self, write: Write) -> list[Write]:
        """The beginning of it."""
        data = write.data
        if len(data) < 2 or not self.hits():
            return [write]
        return [Write(data[: self.random.randint(1, len(data) - 1)], BROKEN_OFF_S)]


class Partial(Fault):
    """A frame in two pieces, with a short pause between them; nothing is lost."""

    stage = 2

    def line(self, write: Write) -> list[Write]:
        """Both pieces."""
        data = write.data
        if len(data) < 2 or not self.hits():
            return [write]
        at = self.random.randint(1, len(data) - 1)
        return [Write(data[:at], PIECE_S), write._replace(data=data[at:])]


class ByteAtATime(Fault):
    """Every byte is a write of its own."""

    stage = 2

    def line(self, write: Write) -> list[Write]:
        """The bytes."""
        if not self.hits() or not write.data:
            return [write]
        pieces = [Write(write.data[k : k + 1]) for k in range(len(write.data))]
        pieces[-1] = pieces[-1]._replace(pause=write.pause)
        return pieces


class Batch(Fault):
    """So many writes at once; what waits goes out when the line has been quiet."""

    stage = 3

    def __init__(self, value: float, seconds: float, seed: int) -> None:
        super().__init__(value, seconds, seed)
        self._held: list[bytes] = []

    def line(self, write: Write) -> list[Write]:
        """Nothing, or all that has waited."""
        self._held.append(write.data)
        if write.pause or len(self._held) >= self.value:
            return [joined._replace(pause=write.pause) for joined in self.flush()]
        return []

    def flush(self) -> list[Write]:
        """All that has waited."""
        held, self._held = self._held, []
        self.strikes += len(held) > 1
        return [Write(b''.join(held))] if held else []
