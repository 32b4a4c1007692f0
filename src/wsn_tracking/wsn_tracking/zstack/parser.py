"""Frames out of a stream of bytes, whatever else is in it.

What is no frame is passed over one byte at a time, so that whatever follows it is found. A stray FE, or a LEN that was
damaged, would swallow what follows; three things prevent that: whether LEN fits the command is checked as soon as it
shows, a candidate whose FCS is wrong is scanned again from its second byte, and a pause of the line ends it.

What sinks say grows with their firmware. A frame that is a little longer than its command is known to be counts where
nothing contradicts it: no sound frame lies within it, and another one, or a pause, follows. A frame of a command that
is not known can have any length: it counts unless a sound frame of a known one lies within it. None of this depends on
how the stream is split.
"""

from __future__ import annotations

from wsn_tracking.zstack.commands import BY_HEADER, shape_of
from wsn_tracking.zstack.frames import MAX_DATA, OVERHEAD, SOF, Frame, Kind, fcs

GROWN = 16  # bytes by which a frame may be longer than its command is known to be
GAP_S = 0.1  # a pause inside a frame that ends it (zstack.md, section 2)

SOUND, WAIT, GREW = 'sound', 'wait', 'grew'  # GREW: no fault, but a reason to look closer

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
        """Bytes that wait for the rest of their frame, or for what follows it; at most 255."""
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
        held, self._held = self._scan(self._held, frames, final=True), b''
        while held:
            self.counters['garbage_bytes'] += 1  # its first byte is a SOF that began no frame
            held = self._scan(held[1:], frames, final=True)
        return frames

    def _scan(self, held: bytes, frames: list[Frame], *, final: bool = False) -> bytes:
        """Append the frames of `held`; the bytes that may still become one. `final`: nothing follows them."""
        at, end, skipped = 0, len(held), 0
        while True:
            start = held.find(SOF, at)
            if start < 0:
                skipped += end - at
                at = end
                break
            skipped += start - at
            at = start
            verdict = _verdict(held, at, end, final=final)
            if verdict == WAIT:
                break
            if verdict != SOUND:
                self.counters[verdict] += 1
                skipped += 1
                at += 1
                continue
            stop = at + held[at + 1] + OVERHEAD
            frames.append(Frame(held[at + 2] << 8 | held[at + 3], held[at + 4 : stop - 1]))
            self.counters['frames'] += 1
            at = stop
        self.counters['garbage_bytes'] += skipped
        return held[at:]


def _verdict(held: bytes, at: int, end: int, *, final: bool) -> str:
    """Whether a frame begins at `at`: SOUND, WAIT for more to tell, or the counter of what is wrong."""
    fault = _fault(held, at, end)
    if fault and fault != GREW:
        return fault
    if (fault == GREW or _is_unknown(held, at, end)) and _sound_within(held, at, end):
        return 'bad_length'
    if at + 1 >= end or (stop := at + held[at + 1] + OVERHEAD) > end:
        return WAIT
    if fcs(held[at + 1 : stop]):  # over the FCS itself too: nothing is left where it is right
        return 'bad_fcs'
    if fault != GREW:
        return SOUND
    if stop == end:
        return SOUND if final else WAIT
    return SOUND if held[stop] == SOF else 'bad_length'


def _fault(held: bytes, at: int, end: int) -> str:
    """Why no frame begins at `at`, as far as can be seen; '' where one may, GREW where it is longer than is known."""
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
    grown = length - shape.high
    count_at = at + 4 + shape.at
    if 0 <= shape.at < length and count_at < end:
        tail = length - shape.at - 1 - shape.unit * held[count_at]
        grown = 0 if tail in shape.tails else max(tail - shape.tails[-1], 1) if tail > shape.tails[0] else GROWN + 1
    is_question = held[at + 2] & 0xE0 == Kind.SREQ  # nothing but this project's commands: they do not grow
    if length < shape.low or grown > (0 if is_question else GROWN):
        return 'bad_length'
    return GREW if grown > 0 else ''


def _is_unknown(held: bytes, at: int, end: int) -> bool:
    """Whether what seems to begin at `at` is of a command that is not known, as far as can be seen."""
    return at + 4 <= end and (held[at + 2] << 8 | held[at + 3]) not in BY_HEADER


def _sound_within(held: bytes, at: int, end: int) -> bool:
    """Whether a frame as it is known lies wholly within the one that seems to begin at `at`."""
    end = min(end, at + held[at + 1] + OVERHEAD)
    while (at := held.find(SOF, at + 1, end)) >= 0:
        stop = at + held[at + 1] + OVERHEAD if at + 1 < end else end + 1
        if stop > end or _is_unknown(held, at, end):
            continue
        if not _fault(held, at, end) and not fcs(held[at + 1 : stop]):
            return True
    return False
