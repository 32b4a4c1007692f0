"""Which reports of different nodes belong together: those of the same request of the same robot.

A request bears its number modulo 256, and every node says which one it measured. Numbers are unwrapped by the time of
measurement: a number that comes back, seconds later, is another request. Times are in ns, on any one clock.
"""

from __future__ import annotations

from typing import NamedTuple

MODULUS = 256
KEPT = 128  # requests of a robot that can still be paired
PAIR_NS = 500_000_000  # measurements of one request are never further apart than that
PAIR_UNNUMBERED_NS = 50_000_000  # where nodes do not say which request


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
    if time_ns < newest_ns:  # measured before the newest one: a request of which nobody else told
        earlier = seq - MODULUS
        if earlier >= 0 and earlier not in dict(robot.requests):
            return _open(robot, earlier, time_ns)
    return _open(robot, seq, time_ns)


def _open(robot: Robot, seq: int, time_ns: int) -> Paired:
    requests = sorted((*robot.requests, (seq, time_ns)))[-KEPT:]
    return Paired(Robot(tuple(requests)), seq, first=True)
