"""Which reports of different nodes belong together: those of the same request of the same robot.

A request bears its number modulo 256, and every node says which one it measured. Numbers are unwrapped by the time of
measurement: a number that comes back, seconds later, is another request. Times are in ns, on any one clock.

The age that a node tells ends where it sends. A report that the network held up (a repeated message, a route that had
to be found) seems to have been measured later than it was: its number tells that it belongs to an earlier request.
"""

from __future__ import annotations

from typing import NamedTuple

MODULUS = 256
KEPT = 128  # requests of a robot that can still be paired
PAIR_NS = 500_000_000  # measurements of one request are never further apart than that
PAIR_UNNUMBERED_NS = 50_000_000  # where nodes do not say which request
HELD_UP_NS = 3_000_000_000  # no network holds a report up for longer


class Robot(NamedTuple):
    """The requests of one robot that were heard of, by their unwrapped numbers."""

    requests: tuple[tuple[int, int], ...] = ()  # (number, time of the first report), ascending


class Paired(NamedTuple):
    """The number of the request, unwrapped; `first`: nobody had reported it before."""

    robot: Robot
    request_seq: int
    first: bool


def pair(robot: Robot, beacon_seq: int | None, time_ns: int, pair_ns: int = PAIR_NS) -> Paired:
    """Find the request that was measured at `time_ns`; beacon_seq None: the one nearest in time."""
    if not robot.requests:
        return _open(robot, beacon_seq or 0, time_ns)
    if beacon_seq is None:
        near = [r for r in robot.requests if abs(time_ns - r[1]) <= PAIR_UNNUMBERED_NS]
    else:
        near = [r for r in robot.requests if r[0] % MODULUS == beacon_seq and abs(time_ns - r[1]) <= pair_ns]
    if near:
        seq, _ = min(near, key=lambda r: abs(time_ns - r[1]))
        return Paired(robot, seq, first=False)
    newest, newest_ns = robot.requests[-1]
    if beacon_seq is None:
        return _open(robot, newest + 1, time_ns)
    seq = newest + ((beacon_seq - newest - 1) % MODULUS) + 1
    earlier = seq - MODULUS
    if earlier < 0:
        return _open(robot, seq, time_ns)
    is_known = earlier in dict(robot.requests)
    if time_ns < newest_ns and not is_known:  # measured before the newest one: a request of which nobody else told
        return _open(robot, earlier, time_ns)
    then_ns = _time_of(robot, earlier, seq, time_ns)
    if then_ns is None:
        return _open(robot, seq, time_ns)
    return Paired(robot, earlier, first=False) if is_known else _open(robot, earlier, then_ns)


def _time_of(robot: Robot, earlier: int, seq: int, time_ns: int) -> int | None:
    """When request `earlier` was, if a report of it was held up until `time_ns`; None where it is of `seq` after all.

    The requests that are known tell how fast the robot counts: `seq` cannot have come in less than half its time. A
    robot that paused counted no faster: what follows the request tells how late it may have been.
    """
    (first, first_ns), (newest, newest_ns) = robot.requests[0], robot.requests[-1]
    if newest - earlier >= KEPT or newest == first:
        return None
    period_ns = (newest_ns - first_ns) / (newest - first)
    if 2 * (time_ns - newest_ns) >= (seq - newest) * period_ns:
        return None
    nearest = min(robot.requests, key=lambda r: abs(r[0] - earlier))
    following = next(request for request in robot.requests if request[0] > earlier or request[0] == newest)
    for number, near_ns in (nearest, following):
        then_ns = round(near_ns + (earlier - number) * period_ns)
        if 0 <= time_ns - then_ns <= HELD_UP_NS:
            return then_ns
    return None


def _open(robot: Robot, seq: int, time_ns: int) -> Paired:
    requests = sorted((*robot.requests, (seq, time_ns)))[-KEPT:]
    return Paired(Robot(tuple(requests)), seq, first=True)
