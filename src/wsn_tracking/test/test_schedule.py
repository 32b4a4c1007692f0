"""Who is told to measure, and who to rest, while targets move, come and go."""

from __future__ import annotations

import numpy as np
from hybrid_cases import recorded
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.sensing.schedule import AGAIN_NS, GONE_NS, Schedule
from wsn_tracking.sensing.scheduler import CellScheduler
from wsn_tracking.simulation.d_cells import nodes
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig

T = 50_000_000
SCHEDULER = CellScheduler(nodes())
EVERYBODY = set(range(1, 13))
START = 10 * AGAIN_NS


def corners(*places):
    return {int(i) for place in places for i in SCHEDULER.corners[int(SCHEDULER.cell(place))]}


class Network:
    """The nodes, as commands leave them."""

    def __init__(self):
        self.schedule, self.active, self.commands = Schedule(SCHEDULER), set(EVERYBODY), 0

    def see(self, target, stamp, place):
        for command in self.schedule.see(target, stamp, None if place is None else np.array(place)):
            self.commands += 1
            (self.active.add if command.active else self.active.discard)(command.node_id)
        return self.active


def test_all_measure_until_a_target_is_found_and_then_its_cell():
    network = Network()
    assert network.see(1, START, None) == EVERYBODY
    assert network.see(1, START + T, [1.0, 1.0]) == corners([1.0, 1.0])
    assert network.see(1, START + 2 * T, None) == EVERYBODY


def test_a_target_that_is_looked_for_wakes_all_and_one_that_has_gone_nobody():
    network = Network()
    network.see(1, START, [1.0, 1.0])
    assert network.see(2, START, None) == EVERYBODY
    assert network.see(1, START + GONE_NS // 2, [1.0, 1.0]) == EVERYBODY
    assert network.see(1, START + GONE_NS + T, [1.0, 1.0]) == corners([1.0, 1.0])


def test_who_knows_is_told_again_now_and_then_and_not_in_between():
    network = Network()
    network.see(1, START, [1.0, 1.0])
    told = network.commands
    for k in range(1, 20):
        network.see(1, START + k * T, [1.0, 1.0])
    assert network.commands == told
    network.active = set()  # all have restarted and rest
    assert network.see(1, START + AGAIN_NS + T, [1.0, 1.0]) == corners([1.0, 1.0])


places = st.tuples(st.floats(-1.0, 5.0), st.floats(-1.0, 7.0))


@properties
@given(st.lists(st.tuples(st.integers(1, 3), st.none() | places), min_size=1, max_size=30))
def test_whoever_is_needed_is_awake(steps):
    """And nobody else, but for cells that are kept a little beyond their border."""
    network, at = Network(), {}
    for k, (target, place) in enumerate(steps):
        active = network.see(target, START + k * T, place)
        at[target] = place
        if None in at.values():
            assert active == EVERYBODY
        else:
            assert len(active) <= 4 * len(at)
            for one in at.values():  # the cell, or the one that it is hardly out of
                low, high = np.array(one) - 0.11, np.array(one) + 0.11
                grown = [corners([x, y]) for x in (low[0], high[0]) for y in (low[1], high[1])]
                assert any(cell <= active for cell in grown)


def test_a_track_predicts_and_a_search_does_not():
    epochs, _ = recorded('d_stop', lasts=4.0)
    tracker = HybridTracker(HybridConfig(), nodes(), 1)
    assert tracker.predicted(0) is None
    last = [tracker.step(epoch)[0] for epoch in epochs[:60]][-1]
    ahead = tracker.predicted(epochs[59].stamp_ns + T)
    np.testing.assert_allclose(ahead[:2], last.mean[:2] + 0.05 * last.mean[2:], rtol=0.0, atol=1e-9)
