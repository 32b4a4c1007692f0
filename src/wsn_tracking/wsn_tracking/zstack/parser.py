"""Frames out of a stream of bytes, whatever else is in it.

What is no frame is passed over one byte at a time, so that whatever follows it is found. A stray FE, or a LEN that was
damaged, would swallow what follows; three things prevent that: whether LEN fits the command is checked as soon as it
shows, a candidate whose FCS is wrong is scanned again from its second byte, and a pause of the line ends it.
"""

from __future__ import annotations

from wsn_tracking.zstack.commands import shape_of
from wsn_tracking.zstack.frames import MAX_DATA, OVERHEAD, SOF, Frame, fcs

GAP_S = 0.1  # a pause inside a frame that ends it (zstack.md, section 2)

COUNTERS = ('frames', 'garbage_bytes', 'bad_length', 'bad_header', 'bad_fcs', 'gaps')


class Parser:
    """Feed it what was read; it holds at most one incomplete frame."""

    def __init__(self, gap_s: float = GAP_S) -> None:
        self.counters = dict.fromkeys(COUNTERS, 0)
        self._gap_s = gap_s
        self._held = b''
        self._last = 0.0

    @property
    def held(self) -> int:
        """Bytes that wait for the rest of their frame; at most 254."""
        return len(self._held)

    def feed(self, data: bytes, now: float) -> list[Frame]:
        """The frames that are complete with `data`, read at time `now` [s]; call it with b'' to have time pass."""
        frames: list[Frame] = []
        if self._held and now - self._last > self._gap_s:
            self.counters['gaps'] += 1
            frames = self.flush()
        if data:
            self._last = now
            self._held = self._scan(self._held + data, frames)
        return frames

    def flush(self) -> list[Frame]:
        """The frames in what is held, when nothing more is to come: the end of a file, or a pause."""
        frames: list[Frame] = []
        held, self._held = self._held, b''
        while held:
            self.counters['garbage_bytes'] += 1  # its first byte is a SOF that began no frame
            held = self._scan(held[1:], frames)
        return frames

    def _scan(self, held: bytes, frames: list[Frame]) -> bytes:
        """Append the frames of `held`; the bytes that may still become one."""
        at, end, skipped = 0, len(held), 0
        while True:
            start = held.find(SOF, at)
            if start < 0:
                skipped += end - at
                at = end
                break
            skipped += start - at
            at = start
            fault = self._fault(held, at, end)
            if fault:
                self.counters[fault] += 1
                skipped += 1
                at += 1
                continue
            if at + 1 >= end or at + held[at + 1] + OVERHEAD > end:
                break
            stop = at + held[at + 1] + OVERHEAD
            if fcs(held[at + 1 : stop]):  # over the FCS itself too: nothing is left where it is right
                self.counters['bad_fcs'] += 1
                skipped += 1
                at += 1
                continue
            frames.append(Frame(held[at + 2] << 8 | held[at + 3], held[at + 4 : stop - 1]))
            self.counters['frames'] += 1
            at = stop
        self.counters['garbage_bytes'] += skipped
        return held[at:]

    @staticmethod
    def _fault(held: bytes, at: int, end: int) -> str:
        """Why no frame begins at `at`, as far as can be seen; '' where one may."""
        if at + 1 >= end:
            return ''
        length = held[at + 1]
        if length > MAX_DATA:
            return 'bad_length'
        if at + 4 > end:
            return ''
        shape = shape_of(held[at + 2] << 8 | held[at + 3])
        if shape is None:
            return 'bad_header'
        if not shape.low <= length <= shape.high:
            return 'bad_length'
        count_at = at + 4 + shape.at
        if 0 <= shape.at < length and count_at < end:
            tail = length - shape.at - 1 - shape.unit * held[count_at]
            if tail not in shape.tails:
                return 'bad_length'
        return ''
