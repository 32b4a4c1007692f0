"""How the firmware reads its serial line: byte by byte, without timeout and without a second look.

A stray FE or a wrong LEN makes it swallow what follows; hosts send 256 bytes EF to get it out of that (zstack.md,
section 2).
"""

from __future__ import annotations

from wsn_tracking.zstack.frames import SOF, Frame, fcs


class FirmwareReader:
    """Feed it what the host sent; it holds at most one incomplete frame."""

    def __init__(self) -> None:
        self.garbage_bytes = 0
        self.bad_fcs = 0
        self._held = bytearray()  # from LEN on; empty before it
        self._in_frame = False

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that are complete with `data`."""
        frames = []
        for byte in data:
            if not self._in_frame:
                self._in_frame = byte == SOF
                self.garbage_bytes += not self._in_frame
                continue
            held = self._held
            held.append(byte)
            if len(held) < held[0] + 4:
                continue
            if fcs(bytes(held)):
                self.bad_fcs += 1
            else:
                frames.append(Frame(held[1] << 8 | held[2], bytes(held[3:-1])))
            self.reset()
        return frames

    def reset(self) -> None:
        """As after power-up."""
        self._held.clear()
        self._in_frame = False
