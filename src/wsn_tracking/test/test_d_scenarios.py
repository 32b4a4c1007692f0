"""The field of six cells: its walks, who measures, and that the base station knows no truth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.bags.read import read
from wsn_tracking.bags.save import save
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.scheduler import CellScheduler, Command
from wsn_tracking.sensing.values import EpochEnd, Range, Request
from wsn_tracking.simulation import d_cells as world
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import SCENARIOS, scenario
from wsn_tracking.simulation.station import SightLine

NAMES = ('d_stop', 'd_arc_stop', 'd_phase', 'd_dropout')
SCHEDULER = CellScheduler(world.nodes(), margin=0.1)


def moves_as_it_says(walk, period):
    """Positions follow velocities, but for the periods in which these change."""
    way = walk[1:, :2] - walk[:-1, :2]
    mean = 0.5 * (walk[1:, 2:] + walk[:-1, 2:]) * period
    return np.mean(np.linalg.norm(way - mean, axis=-1) < 1e-4) > 0.98


@pytest.mark.parametrize('name', NAMES)
def test_walks_stay_in_the_field_and_move_as_their_velocities_say(name):
    s = scenario(name)
    assert name in SCENARIOS
    assert s.anchors.ids.tolist() == list(range(1, 13))
    assert (s.configuration, s.entry_level, s.period) == ('hybrid', 'range', 0.05)
    for walk in (s.truth, *s.companions):
        assert moves_as_it_says(walk, s.period)
        assert np.all((walk[:, :2] > [0.0, 0.0]) & (walk[:, :2] < [4.0, 6.0]))


def test_sudden_stops_are_at_the_border_of_a_cell_and_last():
    for name, speed in (('d_stop', 0.5), ('d_arc_stop', 0.5), ('d_dropout', 0.5)):
        walk = scenario(name).truth
        v = np.hypot(walk[:, 2], walk[:, 3])
        stop = int(np.flatnonzero(v == 0.0)[0])
        np.testing.assert_allclose(v[:stop], speed)
        assert not v[stop:].any()
        assert len(walk) - stop >= 100  # 5 s
        x, y = walk[stop, :2]
        assert min(abs(x - 2.0), abs(y - 2.0), abs(y - 4.0)) < 1e-9


def test_two_robots_are_in_phase_whatever_their_angular_speed():
    for variation in (0.0, 0.1):
        s = scenario('d_phase', {'variation': variation})
        first, (second,) = s.truth, s.companions
        a, b = first[:, :2] - [1.0, 5.0], second[:, :2] - [2.0, 2.0]
        np.testing.assert_allclose(np.hypot(*a.T), 0.5)
        np.testing.assert_allclose(b, 2.0 * a, atol=1e-12)
        turning = np.hypot(*second[:, 2:].T)
        assert np.ptp(turning) == pytest.approx(2.0 * 0.6 * variation, rel=0.01, abs=1e-9)
        np.testing.assert_allclose(turning.mean(), 0.6, rtol=1e-3)


def test_a_recording_holds_every_target_epoch_by_epoch(tmp_path):
    made = record(scenario('d_phase', {'lasts': 1.0}), 1)
    save(tmp_path / 'bag', made)
    bag = read(tmp_path / 'bag')
    assert sorted(bag.truth) == [1, 2]
    np.testing.assert_allclose(bag.truth[2].positions[:, :2], scenario('d_phase', {'lasts': 1.0}).companions[0][:, :2])
    assert [m.target_id for m in bag.messages if isinstance(m, Request)] == [1, 2] * 21
    ends = [m for m in bag.messages if isinstance(m, EpochEnd)]
    assert [e.target_id for e in ends if e.final] == [1, 2]
    assert all(len(e.node_ids) == 1 for e in ends)
    ranges = [m for m in bag.messages if isinstance(m, Range)]
    assert {m.variance for m in ranges} == {0.02**2}
    own = [m._replace(target_id=0) for m in ranges if m.target_id == 1]
    assert own != [m._replace(target_id=0) for m in ranges if m.target_id == 2]
    assert repr(record(scenario('d_phase', {'lasts': 1.0}), 1)) == repr(made)


def test_ranges_are_of_the_nodes_and_lost_as_often_as_is_said():
    config = CellsConfig(dropout=0.3)
    states = np.broadcast_to(scenario('d_stop').truth, (200, 241, 4))
    rng = np.random.default_rng(1)
    told = world.measure(config, states, rng.standard_normal((200, 241)), rng.random((200, 241)))
    assert np.isnan(told.z).mean() == pytest.approx(0.3, abs=0.01)
    true = np.linalg.norm(states[..., :2] - world.nodes().positions[told.rows, :2], axis=-1)
    heard = ~np.isnan(told.z)
    assert np.std((told.z - true)[heard]) == pytest.approx(0.02, rel=0.02)


def test_the_station_finds_the_cell_by_what_it_hears_alone():
    """Two walks that give the same ranges are asked the same nodes; after the first round these are of the cell."""
    states = np.broadcast_to(scenario('d_stop').truth, (50, 241, 4))
    rng = np.random.default_rng(2)
    normals, uniforms = rng.standard_normal((50, 241)), rng.random((50, 241))
    told = world.measure(CellsConfig(), states, normals, uniforms)
    assert told.rows[:, :12].tolist() == [list(range(12))] * 50
    moving = slice(12, 140)  # afterwards the target rests on a border
    cell = SCHEDULER.cell(states[:, moving, :2])
    ids = world.nodes().ids[told.rows[:, moving]]
    of_cell = (SCHEDULER.corners[cell] == ids[..., None]).any(axis=-1)
    assert of_cell.mean() > 0.93  # a border is crossed once, and the cell kept for 0.1 m more

    class Stubborn:
        """Believes in the last cell, whatever it hears."""

        def predict(self, t):
            return np.full((50, 2), [3.0, 5.0])

        def hear(self, t, positions, z):
            self.heard = z

    wrong = world.measure(CellsConfig(), states, normals, uniforms, Stubborn())
    assert set(world.nodes().ids[wrong.rows].ravel().tolist()) == set(SCHEDULER.corners[5].tolist())


def test_a_scenario_takes_any_station():
    asked = []

    class Told(SightLine):
        def predict(self, t):
            asked.append(t)
            return super().predict(t)

    s = world.d_stop(CellsConfig(rest=0.0), lambda: Told(12))
    assert record(s, 1).messages == record(world.d_stop(CellsConfig(rest=0.0)), 1).messages
    assert len(set(asked)) == len(s.truth)


def test_the_sight_line_knows_nothing_at_first_and_loses_no_target_over_lost_ranges():
    station = SightLine(3)
    assert np.isnan(station.predict(0.0)).all()
    a = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]])
    rng = np.random.default_rng(3)
    for k in range(300):
        t = 0.05 * k
        x = np.array([0.5 + 0.1 * t, 0.8])
        z = np.linalg.norm(x - a[k % 3]) if rng.random() > 0.3 else np.nan
        station.hear(t, a[k % 3], np.asarray(z))
        if k > 60:
            assert np.linalg.norm(station.predict(t) - x) < 0.1  # the way of a second


# --- who measures


@properties
@given(st.floats(-1.0, 5.0), st.floats(-1.0, 7.0))
def test_the_cell_is_the_one_round_the_prediction_or_the_nearest(x, y):
    cell = int(SCHEDULER.cell([x, y]))
    inside = np.clip([x, y], [0.0, 0.0], [4.0, 6.0])
    assert np.all(SCHEDULER.low[cell] <= inside)
    assert np.all(inside <= SCHEDULER.high[cell])
    corners = {tuple(world.nodes().positions[i - 1, :2]) for i in SCHEDULER.corners[cell].tolist()}
    low, high = SCHEDULER.low[cell], SCHEDULER.high[cell]
    assert corners == {(a, b) for a in (low[0], high[0]) for b in (low[1], high[1])}


def test_a_target_on_a_border_does_not_toss_the_cells_to_and_fro():
    wiggle = np.array([[1.95 + 0.1 * (k % 2), 1.0] for k in range(10)])
    cell, cells = 0, []
    for p in wiggle:
        cell = int(SCHEDULER.cell(p, cell))
        cells.append(cell)
    assert cells == [0] * 10
    assert int(SCHEDULER.cell([2.11, 1.0], 0)) == 1
    np.testing.assert_array_equal(SCHEDULER.cell([[2.05, 1.0], [2.05, 1.0]], [0, 1]), [0, 1])
    np.testing.assert_array_equal(SCHEDULER.cell([[2.05, 1.0], [0.5, 5.0]]), [1, 4])


def test_the_corners_of_a_cell_take_turns():
    assert sorted(int(SCHEDULER.node(3, k)) for k in range(4)) == sorted(SCHEDULER.corners[3].tolist())
    assert int(SCHEDULER.node(3, 5)) == int(SCHEDULER.node(3, 1))


def test_commands_say_who_measures_from_now_on_and_only_to_those_whom_it_concerns():
    first = SCHEDULER.commands([0])
    assert [c.node_id for c in first] == list(range(1, 13))
    assert {c.node_id for c in first if c.active} == set(SCHEDULER.corners[0].tolist())
    assert SCHEDULER.commands([1], [0]) == (Command(1, False), Command(3, True), Command(4, False), Command(6, True))
    assert SCHEDULER.commands([0], [0]) == ()
    both = SCHEDULER.commands([0, 1], [0])
    assert both == (Command(3, True), Command(6, True))  # another target needs the common corners all the same


def test_nodes_that_form_no_cells_are_refused():
    for xy in ([[0, 0], [1, 0], [2, 0]], [[0, 0], [1, 0], [0, 1]], [[0, 0], [1, 0.2], [0, 1], [1, 1]]):
        with pytest.raises(TrackingError, match=r'are no grid of cells: .* leave all nodes measuring'):
            CellScheduler(make_anchors(range(1, len(xy) + 1), xy))
