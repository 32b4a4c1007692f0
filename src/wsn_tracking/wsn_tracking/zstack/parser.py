"""Frames out of a stream of bytes, whatever else is in it.

What is no frame is passed over one byte at a time, so that whatever follows it is found. A stray FE, or a LEN that was
damaged, would swallow what follows; three things prevent that: whether LEN fits the command is checked as soon as it
shows, a candidate whose FCS is wrong is scanned again from its second byte, and a pause of the line ends it. Of
candidates that overlap `candidates` picks the true one. None of this depends on how the stream is split.
"""

from __future__ import annotations

from wsn_tracking.zstack.candidates import SOUND, WAIT, Stream, verdict
from wsn_tracking.zstack.fit import LONGEST, end_of
from wsn_tracking.zstack.frames import SOF, Frame

GAP_S = 0.1  # a pause inside a frame that ends it (zstack.md, section 2)
MAX_HELD = 3 * LONGEST  # a frame, one that overlaps it, and the one behind that

COUNTERS = ('frames', 'garbage_bytes', 'bad_length', 'bad_header', 'bad_fcs', 'gaps')


class Parser:
    """Feed it what was read; it holds what may become a frame."""

    def __init__(self, gap_s: float = GAP_S) -> None:
        self.counters = dict.fromkeys(COUNTERS, 0)
        self._gap_s = gap_s
        self._held = b''
        self._in_step = True  # what is held comes straight after a frame, or after a pause
        self._due = 0  # as in Stream
        self._last = 0.0

    @property
    def held(self) -> int:
        """Bytes that wait for the rest of their frame, or for what follows it; at most MAX_HELD."""
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
        self._held = self._scan(self._held, frames, ended=True)
        self._in_step, self._due = True, 0
        return frames

    def _scan(self, held: bytes, frames: list[Frame], *, ended: bool = False) -> bytes:
        """Append the frames of `held`; the bytes that may still become one. `ended`: nothing follows them."""
        stream = Stream(held, ended, self._due)
        at, end, skipped = 0, len(held), 0
        while at < end:
            start = held.find(SOF, at)
            if start != at:
                start = end if start < 0 else start
                self._in_step = False
                skipped += start - at
                at = start
                continue
            found = verdict(stream, at, in_step=self._in_step)
            if found == SOUND:
                stop = end_of(held, at)
                frames.append(Frame(held[at + 2] << 8 | held[at + 3], held[at + 4 : stop - 1]))
                self.counters['frames'] += 1
                self._in_step = True
                at = stop
                continue
            if found != WAIT:
                self.counters[found] += 1
            elif not ended:
                break
            if self._in_step:
                stream = stream._replace(due=end_of(held, at))
            self._in_step = False
            skipped += 1
            at += 1
        self.counters['garbage_bytes'] += skipped
        self._due = stream.due - at
        return held[at:]
