"""Each message of a node once: duplicates, disorder, loss and restarts by its sequence number and its clock.

The radio repeats messages (APS retries, relayed broadcasts) and lets them overtake each other. A window remembers the
last 64 numbers of a node and the node's time of each; numbers count modulo 2^16, times modulo 2^32 ms. A repeated
message is the same message: same number, same time, not much later. A node that has restarted begins both anew; then
its clock cannot show more than the time since it was last heard.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

WIDTH = 64
SEQ_MODULUS = 1 << 16
TIME_MODULUS = 1 << 32
LATE_MS = 3000  # no message comes later than that, nor a repeated one, where nothing but the time can tell
DELAY_MS = 60_000  # what the host may have been held up


class Verdict(Enum):
    """What a message is; all but DUPLICATE are new."""

    NEW = 'new'
    DUPLICATE = 'duplicate'
    REORDERED = 'reordered'  # has been overtaken
    RESTARTED = 'restarted'  # of a node that began anew
    LATE = 'late'  # too old to be told from a duplicate


class Arrival(NamedTuple):
    """Node clock of a message, and host clock when it came."""

    t_ms: int
    heard_ms: int


class Window(NamedTuple):
    """The newest messages of one node, by how far their number lies behind the newest; None: has not come."""

    newest: int
    arrivals: tuple[Arrival | None, ...]


class Seen(NamedTuple):
    """The verdict, the window that results, and by how much the number of lost messages has changed."""

    window: Window
    verdict: Verdict
    lost: int = 0


def begin(seq: int, t_ms: int, now_ms: int, verdict: Verdict = Verdict.NEW) -> Seen:
    """The first message of a node."""
    return Seen(Window(seq, (Arrival(t_ms, now_ms),)), verdict)


def see(window: Window, seq: int, t_ms: int, now_ms: int, *, retry: bool = False) -> Seen:
    """Judge a message that came at `now_ms`; `retry`: the node says that it repeats one, perhaps with a new time."""
    newest, this = window.arrivals[0], Arrival(t_ms, now_ms)
    assert newest is not None
    ahead = _signed(seq - window.newest, SEQ_MODULUS)
    later_ms = _signed(t_ms - newest.t_ms, TIME_MODULUS)
    silent_ms = now_ms - newest.heard_ms
    began_anew = later_ms > 0 or t_ms <= silent_ms + DELAY_MS
    restarted = begin(seq, t_ms, now_ms, Verdict.RESTARTED)
    if ahead > 0:
        if later_ms <= -LATE_MS and began_anew:
            return restarted
        gap: tuple[Arrival | None, ...] = (None,) * min(ahead - 1, WIDTH)
        return Seen(Window(seq, (this, *gap, *window.arrivals)[:WIDTH]), Verdict.NEW, ahead - 1)
    behind = -ahead
    if behind >= len(window.arrivals):
        if behind < WIDTH and -LATE_MS < later_ms <= 0:  # before the first one that we heard
            gap = (None,) * (behind - len(window.arrivals))
            return Seen(window._replace(arrivals=(*window.arrivals, *gap, this)), Verdict.REORDERED, len(gap))
        return restarted if began_anew else Seen(window, Verdict.LATE)
    known = window.arrivals[behind]
    if known is None:
        if began_anew and not _in_order(window, behind, t_ms):
            return restarted
        arrivals = (*window.arrivals[:behind], this, *window.arrivals[behind + 1 :])
        return Seen(window._replace(arrivals=arrivals), Verdict.REORDERED, -1)
    if known.t_ms == t_ms:  # a node that restarted may come by the same time at the same number
        is_repeated = now_ms - known.heard_ms <= LATE_MS or t_ms > silent_ms
    else:
        is_repeated = (retry and later_ms > -LATE_MS) or not began_anew
    return Seen(window, Verdict.DUPLICATE) if is_repeated else restarted


def _in_order(window: Window, behind: int, t_ms: int) -> bool:
    """Whether the time lies between those of the numbers before and after."""
    after = next(arrival for arrival in reversed(window.arrivals[:behind]) if arrival is not None)
    before = next((arrival for arrival in window.arrivals[behind + 1 :] if arrival is not None), None)
    early = _signed(t_ms - after.t_ms, TIME_MODULUS)
    if before is None:
        return -LATE_MS < early <= 0
    return early <= 0 <= _signed(t_ms - before.t_ms, TIME_MODULUS)


def _signed(difference: int, modulus: int) -> int:
    """The difference of two numbers that wrap: the shorter way round."""
    return (difference + modulus // 2) % modulus - modulus // 2
