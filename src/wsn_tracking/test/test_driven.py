"""The robot that keeps in phase: its controller, its wheels, and the whole loop over the network."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import properties

from wsn_tracking.simulation import d_cells
from wsn_tracking.simulation.d_cells import CellsConfig
from wsn_tracking.simulation.driven import (
    DrivenRobot,
    FollowConfig,
    Wheels,
    learnt,
    moved,
    phase_error,
    wheels,
)
from wsn_tracking.studies import phase, phase_plot
from wsn_tracking.studies.phase_runs import PhaseConfig, run

FOLLOW = FollowConfig()
RIGHT = 0.5 * np.pi
angles = st.floats(-3.1, 3.1)


def on(circle, angle, radius=1.0):
    return np.array(circle) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# ---- the controller


@given(angles, angles)
@properties
def test_the_error_is_the_angle_that_is_missing(one, other):
    error = phase_error(FOLLOW, on(FOLLOW.first_centre, one, 0.5), on(FOLLOW.centre, other))
    assert np.exp(1j * error) == pytest.approx(np.exp(1j * (one - other)))
    assert -np.pi < error <= np.pi


@given(angles)
@properties
def test_in_phase_on_its_circle_it_goes_on_round(angle):
    drive = wheels(FOLLOW, np.array(0.6), np.array(0.0), on(FOLLOW.centre, angle), np.array(angle + RIGHT))
    assert (float(drive.v), float(drive.w)) == pytest.approx((0.6, 0.6))


def test_it_is_faster_behind_slower_ahead_and_never_backwards():
    place, heading = on(FOLLOW.centre, 0.3), np.array(0.3 + RIGHT)
    v = [float(wheels(FOLLOW, np.array(0.6), np.array(e), place, heading).v) for e in (-2.0, -0.2, 0.0, 0.2, 3.0)]
    assert v == pytest.approx([0.0, 0.3, 0.6, 0.9, FOLLOW.most_speed])


def test_outside_it_turns_inwards_and_inside_outwards():
    heading = np.array(0.3 + RIGHT)
    out, within = (wheels(FOLLOW, np.array(0.6), np.array(0.0), on(FOLLOW.centre, 0.3, r), heading) for r in (1.2, 0.8))
    assert within.w < 0.6 < out.w


def test_what_is_learnt_is_bounded_in_time_and_size():
    half = learnt(FOLLOW, np.array(0.5), np.array(0.1), np.array(0.5))
    assert half == pytest.approx(0.5 + FOLLOW.rate_gain * 0.05)
    assert learnt(FOLLOW, np.array(0.5), np.array(0.1), np.array(1e6)) == pytest.approx(0.5 + FOLLOW.rate_gain * 0.1)
    assert learnt(FOLLOW, np.array(1.1), np.array(3.0), np.array(1.0)) == FOLLOW.most_speed / FOLLOW.radius


@given(angles, st.floats(0.0, 1.2), st.floats(-3.0, 3.0), st.floats(0.01, 0.5))
@properties
def test_wheels_move_along_an_arc(heading, v, w, dt):
    """Against a thousand small straight steps, whose error falls as their length."""
    state, small = np.array([1.0, 2.0, heading]), np.array([1.0, 2.0, heading])
    for _ in range(1000):
        small = small + dt / 1000 * np.array([v * np.cos(small[2]), v * np.sin(small[2]), w])
    after = moved(state, Wheels(np.array(v), np.array(w)), dt)
    assert after[:2] == pytest.approx(small[:2], abs=2e-3 * dt * (1.0 + abs(w)))
    assert np.exp(1j * after[2]) == pytest.approx(np.exp(1j * small[2]), abs=1e-9)


def test_functions_take_leading_axes():
    first, second = on(FOLLOW.first_centre, np.linspace(0, 3, 6).reshape(2, 3)), on(FOLLOW.centre, np.zeros((2, 3)))
    error = phase_error(FOLLOW, first, second)
    drive = wheels(FOLLOW, np.full((2, 3), 0.5), error, second, np.zeros((2, 3)))
    one = wheels(FOLLOW, np.array(0.5), error[1, 2], second[1, 2], np.array(0.0))
    assert (drive.v[1, 2], drive.w[1, 2]) == pytest.approx((float(one.v), float(one.w)))
    assert moved(np.zeros((2, 3, 3)), drive, 0.1).shape == (2, 3, 3)


# ---- the robot


def driven(behind=1.0, hears=lambda t: True, lasts=30.0, rate=0.6):
    """Errors of a robot that is told the truth at 10 Hz, every 0.1 s."""
    robot, errors = DrivenRobot(FOLLOW, -behind), []
    for t in np.arange(0.0, lasts, 0.1):
        first = on(FOLLOW.first_centre, rate * t, 0.5)
        robot.advance(t)
        if hears(t):
            robot.hear_own(robot.state[:2], t)
            robot.hear_first(first, t)
        errors.append(float(phase_error(FOLLOW, first, robot.state[:2])))
    return np.array(errors), robot


@pytest.mark.parametrize('behind', [-3.0, -1.0, 0.5, 2.0, 3.0])
def test_it_catches_up_from_anywhere_and_stays(behind):
    errors, robot = driven(behind)
    assert abs(errors[0]) == pytest.approx(abs(behind))
    assert np.abs(errors[200:]).max() < np.radians(1.0)
    assert np.hypot(*(robot.state[:2] - FOLLOW.centre)) == pytest.approx(1.0, abs=0.02)
    assert np.hypot(*robot.state[2:]) == pytest.approx(0.6, abs=0.02)


def test_it_stands_until_it_knows_both_and_once_it_is_told_nothing():
    robot = DrivenRobot(FOLLOW, 0.0)
    robot.hear_first(on(FOLLOW.first_centre, 1.0, 0.5), 0.0)
    robot.advance(2.0)
    assert robot.state.tolist() == pytest.approx([3.0, 2.0, 0.0, 0.0])
    _, robot = driven(hears=lambda t: t < 10.0, lasts=20.0)
    assert np.hypot(*robot.state[2:]) == 0.0


def test_a_gap_in_what_it_is_told_is_bridged():
    """Nine tenths of a second at 0.6 rad/s would be 31 degrees."""
    errors, _ = driven(hears=lambda t: t < 20.0 or t % 1.0 < 0.05)
    assert np.abs(errors[200:]).max() < np.radians(3.0)


# ---- the loop


@pytest.fixture(scope='module')
def short():
    """Twenty-five seconds of the whole loop."""
    return run(PhaseConfig(cells=CellsConfig(lasts=25.0)), 1)


def test_the_second_robot_keeps_in_phase_by_what_is_estimated(short):
    """The study's RMS is 1.7 degrees, its worst instant 4."""
    settled = short.times > 15.0
    assert np.sqrt(np.mean(short.error[settled] ** 2)) < np.radians(4.0)
    assert np.degrees(short.error[0]) == pytest.approx(np.degrees(2.0))
    tracked = np.sqrt(np.nanmean(np.sum((short.estimates - short.truth[..., :2])[:, settled] ** 2, axis=-1)))
    assert tracked < 0.05


def test_the_first_robot_is_that_of_the_scenario(short):
    np.testing.assert_array_equal(short.truth[0], d_cells.d_phase(CellsConfig(lasts=25.0)).truth)


def test_feedback_that_never_comes_leaves_it_standing():
    deaf = run(PhaseConfig(cells=CellsConfig(lasts=3.0), loss=1.0), 1)
    np.testing.assert_array_equal(deaf.truth[1], np.broadcast_to(deaf.truth[1, 0], deaf.truth[1].shape))


def test_a_run_depends_on_its_seed_alone():
    config = replace(PhaseConfig(cells=CellsConfig(lasts=3.0)), loss=0.3)
    one, again, other = run(config, 1), run(config, 1), run(config, 2)
    np.testing.assert_array_equal(one.error, again.error)
    assert not np.array_equal(one.error, other.error)


def test_the_study_is_plain_json_and_the_picture_is_drawn(tmp_path, capsys):
    found = phase.phase(runs=1, lasts=2.0, settled=1.0)
    assert found == json.loads(json.dumps(found, allow_nan=False))
    assert {*found['variants']} == {*phase.variants()}
    assert phase_plot.main(['-o', str(tmp_path / 'phase.png'), '--lasts', '2']) == 0
    assert (tmp_path / 'phase.png').read_bytes()[:4] == b'\x89PNG'
    assert phase_plot.main(['-o', str(tmp_path / 'other.png'), '--lasts', '0.1', '--seed', '2']) == 0
    assert len(capsys.readouterr().out.split()) == 2
