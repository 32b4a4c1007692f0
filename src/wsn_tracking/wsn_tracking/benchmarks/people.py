"""The human tracker as a process: what it takes of a core while a person walks, and how much it bears."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking import graphs
from wsn_tracking.benchmarks.graph import Played, play
from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, at_most
from wsn_tracking.errors import TrackingError

GROUP = 'people'
TRACKER = 'human_tracker'


def rows(sizes: Sizes) -> Iterable[Row]:
    """1000 particles at 2 Hz, 10 000 at 10 Hz; 16 nodes, all heard."""
    work = 'human_tracker_node, 16 nodes, 1000 particles at 2 Hz'
    many = 'the same, 10 000 particles at 10 Hz, at rate max'
    try:
        share = walked(sizes.walk_s, 0.5, 1000, rate=1.0).share
        yield Row(GROUP, work, '% of a core', None if share is None else 100.0 * share, goal=at_most(5.0))
        speed = walked(2.0 * sizes.walk_s, 0.1, 10_000, rate=0.0).speed
        yield Row(GROUP, many, 'x real time', speed, goal=at_least(1.0))
    except TrackingError as error:
        yield Row(GROUP, f'{work}; {many}', '', None, note=' '.join(str(error).split()))


def walked(duration: float, period: float, particles: int, rate: float) -> Played:
    """c_walk through the live graph, every node heard in every epoch."""
    settings = [f'duration={duration:g}', f'period={period:g}', 'reach=1e6']
    graph = graphs.simulation(
        'c_walk', 1, scenario_settings=settings, rate=rate, settings={'particles': particles}, trackers='human'
    )
    return play(graph, timeout=20.0 * duration + 60.0, watch=TRACKER)
