"""How people walk in the scenarios of seed 003: legs, pauses, hot spots, turns, jumps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.simulation.c_body import CorridorConfig, people
from wsn_tracking.simulation.c_mobility import Mobility, legs, teleported, turned_body
from wsn_tracking.simulation.scenarios import scenario

T = 0.1 * np.arange(2000)
AREA = (0.0, 0.0, 100.0, 100.0)


def walked(mobility=None, runs=40, times=T, seed=1):
    rng = np.random.default_rng(seed)
    return legs(mobility or Mobility(AREA), 100.0 * rng.random((runs, 2)), times, rng)


def test_legs_are_straight_and_speeds_are_within_theirs():
    states, heading = walked()
    speed = np.hypot(states[..., 2], states[..., 3])
    walks = speed > 0.0
    assert speed[walks].min() >= 0.5
    assert speed.max() <= 2.0
    np.testing.assert_allclose(states[..., 2][walks], (speed * np.cos(heading))[walks], atol=1e-12)
    np.testing.assert_allclose(states[..., 3][walks], (speed * np.sin(heading))[walks], atol=1e-12)
    same = np.all(states[:, 1:, 2:] == states[:, :-1, 2:], axis=-1)
    step = states[:, 1:, :2] - states[:, :-1, :2] - 0.1 * states[:, 1:, 2:]
    assert np.abs(step[same]).max() < 1e-9
    assert np.abs(step).max() < 0.4 + 1e-9  # at a corner at most the way of a step there and one on
    assert states[..., :2].min() >= 0.0
    assert states[..., :2].max() <= 100.0


def test_pauses_are_uniform_and_keep_the_heading():
    states, heading = walked(runs=200)
    still = np.hypot(states[..., 2], states[..., 3]) == 0.0
    lengths = []
    for r in range(len(still)):
        edges = np.flatnonzero(np.diff(np.r_[False, still[r], False]))
        for begin, end in edges.reshape(-1, 2):
            assert np.ptp(heading[r, max(begin - 1, 0) : end]) == 0.0
            assert np.ptp(states[r, begin:end, :2], axis=0).max() < 1e-9
            if begin > 0 and end < T.size:
                lengths.append(0.1 * (end - begin))
    assert max(lengths) <= 10.1
    assert np.mean(lengths) == pytest.approx(5.0, abs=5.0 * 10.0 / math.sqrt(12.0 * len(lengths)) + 0.1)


@properties
@given(seed=st.integers(0, 1000), k=st.integers(1, 300), pause=st.sampled_from([0.0, 5.0]))
def test_a_longer_walk_begins_like_a_shorter_one(seed, k, pause):
    mobility = Mobility(AREA, longest_pause=pause, turn_after=20.0)
    whole, part = (walked(mobility, 3, times, seed) for times in (T[:300], T[:k]))
    np.testing.assert_array_equal(whole.states[:, :k], part.states)
    np.testing.assert_array_equal(whole.heading[:, :k], part.heading)


def test_people_go_to_hot_spots_as_often_as_they_should():
    """Ends of legs that lie on a spot: the share 0.7 of them."""
    spots = ((10.0, 10.0), (90.0, 20.0))
    mobility = Mobility(AREA, 5.0, 5.0, 10.0, hot_spots=spots, hot_share=0.7)
    states, _ = walked(mobility, 60)
    still = np.hypot(states[..., 2], states[..., 3]) == 0.0
    begins = still & ~np.roll(still, 1, axis=1)
    begins[:, 0] = False
    places = states[begins][:, :2]
    on = [np.all(np.abs(places - spot) < 1e-6, axis=-1) for spot in spots]
    assert np.mean(on[0] | on[1]) == pytest.approx(0.7, abs=5.0 * math.sqrt(0.21 / len(places)))
    assert 0.4 < on[0].sum() / (on[0] | on[1]).sum() < 0.6


def test_sudden_turns_come_after_their_time():
    """Legs are far longer than patience: 200 s hold 200 / 5 turns."""
    mobility = Mobility((0.0, 0.0, 1e5, 1e5), 1.0, 1.0, 5.0, turn_after=5.0)
    _, heading = walked(mobility, 100)
    turns = np.sum(heading[:, 1:] != heading[:, :-1], axis=-1)
    assert turns.mean() == pytest.approx(40.0, abs=5.0 * math.sqrt(40.0 / 100.0))


def test_who_is_teleported_is_half_the_area_away():
    rng = np.random.default_rng(2)
    before = walked(runs=10)
    after = teleported(Mobility(AREA), before, T, 100.0, rng)
    np.testing.assert_array_equal(after.states[:, :1000], before.states[:, :1000])
    jump = np.abs(after.states[:, 1000, :2] - after.states[:, 999, :2])
    np.testing.assert_allclose(jump, 50.0)
    assert after.states.shape == before.states.shape
    assert teleported(Mobility(AREA), before, T, 1e4, rng) is before


def test_a_body_turns_as_it_is_said_to():
    yaw = turned_body(T, 0.5, 10.0, 2000, np.random.default_rng(3))
    for k in (0, 50, 1999):
        assert yaw[:, k].std() == pytest.approx(0.5, rel=0.07)
    assert np.mean(yaw[:, 0] * yaw[:, 100]) == pytest.approx(0.25 * math.exp(-1.0), abs=0.03)
    assert not turned_body(T, 0.0, 10.0, 2, np.random.default_rng(3)).any()


def test_the_circle_is_counter_clockwise_at_one_metre_a_second():
    s = scenario('c_circle')
    x, y, v_x, v_y = s.truth.T
    np.testing.assert_allclose(np.hypot(x, y), 10.0)
    np.testing.assert_allclose(np.hypot(v_x, v_y), 1.0)
    np.testing.assert_allclose(x * v_y - y * v_x, 10.0)
    assert s.area == (-15.0, -15.0, 15.0, 15.0)
    assert s.truth.shape == (361, 4)


def test_the_corridor_is_walked_slowly_along_its_middle():
    person = people(CorridorConfig(), 20, np.random.default_rng(1))
    assert person.states[..., 1].min() >= 0.5
    assert person.states[..., 1].max() <= 1.5
    np.testing.assert_allclose(np.hypot(person.states[..., 2], person.states[..., 3]), 0.3)
