"""Whether a frame begins where bytes look like one.

A check of one byte lets one of 256 false frames pass, and wherever FE lies within data one may begin. So that a false
one takes no sound one with it, more is asked:

- Its LEN has to fit its command. Where the command sets it no bounds, a frame of another that does fit is rather one
  that was swallowed.
- Another frame may begin within it and go on behind its end. Of two that overlap, one whose LEN fits exactly is true,
  for that hardly ever happens by chance; else the one from where a frame is due, or that is followed by one. Where the
  first came straight after another frame, or after a pause, and both fit alike, it is true unless its LEN was damaged:
  the other one begins at the end of a lesser LEN.

None of this depends on how much has come: what cannot be told yet is waited for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from wsn_tracking.zstack.fit import OPEN, end_of, fit_of
from wsn_tracking.zstack.frames import OVERHEAD, SOF, fcs

SOUND, WAIT = 'sound', 'wait'


class Stream(NamedTuple):
    """The bytes that are held.

    `ended`: nothing follows them. `due`: where the next frame begins if the last one was damaged, but not in its LEN.
    """

    held: bytes
    ended: bool = False
    due: int = 0


def verdict(stream: Stream, at: int, *, in_step: bool) -> str:
    """Whether a frame begins at `at`, an FE: SOUND, WAIT for more to tell, or the counter of what is wrong.

    `in_step`: it comes straight after another frame, or after a pause.
    """
    held = stream.held
    fault, lesser, is_exact = fit_of(held, at)
    if fault:
        return fault
    stop = end_of(held, at)
    if lesser and not is_exact and _known_within(held, at + 1, min(stop, len(held))):
        return 'bad_length'
    if stop > len(held):
        return WAIT
    if fcs(held[at + 1 : stop]):  # over the FCS itself too: nothing is left where it is right
        return 'bad_fcs'
    if held.find(SOF, at + 1, stop) < 0:
        return SOUND
    within = [place for place in range(at + 1, stop) if held[place] == SOF]
    exact = [place for place in within if _may_be_exact(held, place)]
    if not is_exact:  # which hardly ever happens by chance
        beaten = [_leads_beyond(stream, rival, stop) for rival in exact]
        if True in beaten or None in beaten:
            return 'bad_length' if True in beaten else WAIT
    rivals = exact if is_exact else within
    if in_step:
        ends = {at + OVERHEAD + length for length in lesser}
        rivals = [rival for rival in rivals if rival in ends and not fcs(_shortened(held[at:rival]))]
    return _contest(stream, rivals, stop) if rivals else SOUND


def _shortened(frame: bytes) -> bytes:
    """What the FCS of a frame is over, had LEN been damaged and this were all of it; with the FCS."""
    return bytes((len(frame) - OVERHEAD,)) + frame[2:]


def _contest(stream: Stream, rivals: Sequence[int], stop: int) -> str:
    """What becomes of a frame that ends at `stop`, where others of its kind may begin at `rivals` within it."""
    expected = stream.due in rivals and _leads_on(stream, stream.due, stop)
    if expected is not False:
        return 'bad_length' if expected else WAIT
    followed = _begins(stream, stop)
    if followed:
        return SOUND
    fates = [_leads_on(stream, rival, stop) for rival in rivals]
    if followed is False and True in fates:
        return 'bad_length'
    return WAIT if True in fates or None in fates else SOUND


def _leads_beyond(stream: Stream, rival: int, stop: int) -> bool | None:
    """Whether sound frames, one after the other from `rival` on, lead beyond `stop`; None: that is not told yet."""
    end = _end_of_row(stream, rival, stop)
    return None if end is None else end > stop


def _leads_on(stream: Stream, rival: int, stop: int) -> bool | None:
    """Whether they do and lead to another frame; those from where a frame is due need not lead beyond."""
    end = _end_of_row(stream, rival, stop)
    if not end:
        return None if end is None else False
    return (end > stop or rival == stream.due) and _begins(stream, end)


def _end_of_row(stream: Stream, at: int, stop: int) -> int | None:
    """Where sound frames, one after the other from `at` on, end at or beyond `stop`; 0: they do not lead there."""
    while at < stop:
        is_one = _begins(stream, at)
        if not is_one:
            return 0 if is_one is False else None
        at = end_of(stream.held, at)
    return at


def _may_be_exact(held: bytes, at: int) -> bool:
    """Whether the frame that seems to begin at `at` is, as far as can be seen, just as long as its command is known."""
    fit = fit_of(held, at)
    return fit.is_exact or fit is OPEN


def _begins(stream: Stream, at: int) -> bool | None:
    """Whether a frame with the right check begins at `at`, or the stream ends there; None: that is not told yet."""
    held = stream.held
    if at == len(held):
        return stream.ended or None
    if held[at] != SOF or fit_of(held, at).fault:
        return False
    stop = end_of(held, at)
    if stop > len(held):
        return False if stream.ended else None
    return not fcs(held[at + 1 : stop])


def _known_within(held: bytes, at: int, end: int) -> bool:
    """Whether a frame that is just as long as its command is known to be lies wholly between `at` and `end`."""
    while (at := held.find(SOF, at, end)) >= 0:
        stop = end_of(held, at)
        if stop <= end and fit_of(held, at).is_exact and not fcs(held[at + 1 : stop]):
            return True
        at += 1
    return False
