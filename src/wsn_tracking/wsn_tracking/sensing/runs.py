"""Where a new run begins: a looped bag falls back in time, a target that was restarted in number alone."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.sensing.open_epochs import Listing
from wsn_tracking.sensing.values import Measurement, Request

JUMP_NS = 1_000_000_000  # requests that fall back by more than this are a new run

Message = Request | Measurement | Listing


def begins(request: Request, newest: Request | None) -> bool:
    """Whether a request after the newest one begins a new run."""
    if newest is None:
        return False
    in_the_past = request.stamp_ns < newest.stamp_ns - JUMP_NS
    return in_the_past or (request.seq <= newest.seq and request.stamp_ns > newest.stamp_ns)


def falls_back(first: Message, newest: Request | None) -> bool:
    """Whether a run that begins with this request falls back in time, not only in number."""
    return newest is not None and first.stamp_ns < newest.stamp_ns


def is_stray(first: Message, second: Request, newest: Request | None) -> bool:
    """Whether a request that fell back in time was one bad stamp: the next one goes on where the old run was."""
    return newest is not None and falls_back(first, newest) and second.stamp_ns > newest.stamp_ns


def is_confirmed(run: Sequence[Message], newest: Request | None) -> bool:
    """A jump back counts when a second request follows it there; a new numbering counts at once."""
    first, *others = run
    return not falls_back(first, newest) or any(isinstance(message, Request) for message in others)
