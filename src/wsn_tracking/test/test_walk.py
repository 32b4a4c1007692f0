"""Transitions of particles: their moments, their bounds, and what they leave alone."""

import math

import numpy as np
import pytest

from wsn_tracking.models.walk import (
    PSI,
    SPEED,
    STATES,
    VX,
    VY,
    WALKING,
    YAW,
    Disc,
    RandomWalk,
    Walk,
    X,
    Y,
    beyond,
    disc,
    drawn,
    kept,
    random_walk,
    walk,
    within,
)

P = 20_000
MODELS = {'disc': disc(Disc(4.0)), 'random_walk': random_walk(RandomWalk(0.6)), 'walk': walk(Walk())}
KINDS = pytest.mark.parametrize('kind', sorted(MODELS))


def particles(*batch, model=None, seed=1, extra=0):
    rng = np.random.default_rng(seed)
    s = drawn(model or Walk(), 100.0 * rng.random((*batch, 2, P)), rng)
    return np.concatenate([s, rng.standard_normal((*batch, extra, P))], axis=-2)


def moved(kind, s, dt, seed=2):
    return MODELS[kind](s, dt, np.random.default_rng(seed))


@KINDS
@pytest.mark.parametrize('dt', [0.0, -1.0])
def test_nobody_moves_in_no_time(kind, dt):
    s = particles()
    np.testing.assert_array_equal(moved(kind, s, dt), s)


@KINDS
def test_rows_of_the_caller_and_the_input_are_left_alone(kind):
    s = particles(2, extra=3)
    before = s.copy()
    new = moved(kind, s, 0.5)
    np.testing.assert_array_equal(s, before)
    np.testing.assert_array_equal(new[:, STATES:], s[:, STATES:])
    assert new.shape == s.shape


@KINDS
def test_velocity_has_the_direction_and_the_length_of_the_way(kind):
    """But for the little that a walker sways; who pauses has none and keeps his direction."""
    s = particles()
    new = moved(kind, s, 0.5)
    way = new[: Y + 1] - s[: Y + 1]
    np.testing.assert_allclose(0.5 * new[VX : VY + 1], way, atol=0.2 if kind == 'walk' else 1e-12)
    walks = new[WALKING] > 0.0
    assert kind != 'walk' or np.all(new[VX : VY + 1, ~walks] == 0.0)
    along = new[VX] * np.cos(new[PSI]) + new[VY] * np.sin(new[PSI])
    np.testing.assert_allclose(along, np.hypot(new[VX], new[VY]), atol=1e-12)


def test_a_disc_is_filled_evenly():
    """Share of the disc within a radius r is (r / R)^2; the variance per axis is R^2 / 4 (seed 003, eq. 11)."""
    step = moved('disc', particles(), 0.5)[: Y + 1] - particles()[: Y + 1]
    r = np.hypot(*step)
    assert r.max() <= 2.0
    for share in (0.1, 0.5, 0.9):
        assert np.mean(r < 2.0 * math.sqrt(share)) == pytest.approx(share, abs=4.0 * math.sqrt(0.25 / P))
    np.testing.assert_allclose(step.var(axis=-1), 1.0, rtol=0.04)
    assert np.abs(step.mean(axis=-1)).max() < 0.03


def test_a_random_walk_grows_with_the_root_of_time():
    for dt in (0.5, 2.0):
        step = moved('random_walk', particles(), dt)[: Y + 1] - particles()[: Y + 1]
        np.testing.assert_allclose(step.std(axis=-1), 0.6 * math.sqrt(dt), rtol=0.03)


def test_a_random_walk_whose_direction_nobody_asks_for_is_the_same():
    s = particles()
    blind = random_walk(RandomWalk(0.6, faces=False))(s, 0.5, np.random.default_rng(2))
    faced = moved('random_walk', s, 0.5)
    rows = [X, Y, VX, VY]
    np.testing.assert_array_equal(blind[rows], faced[rows])
    np.testing.assert_array_equal(blind[PSI], s[PSI])


def test_walkers_stay_what_they_are_on_the_average():
    """Shares and spreads that `drawn` begins with are those that the walk keeps, whatever dt is."""
    model = Walk()
    for dt in (0.25, 1.0):
        s, rng = particles(), np.random.default_rng(3)
        for _ in range(int(20.0 / dt)):
            s = walk(model)(s, dt, rng)
        # chances of a step are those of a process in continuous time: stepping in dt is right to dt / (2 x 5 s)
        assert np.mean(s[WALKING]) == pytest.approx(30.0 / 35.0, abs=0.015)
        assert s[YAW].std() == pytest.approx(0.6, rel=0.03)
        assert s[SPEED].min() >= 0.5
        assert s[SPEED].max() <= 2.0
        assert s[SPEED].mean() == pytest.approx(1.25, abs=0.03)
        assert np.abs(np.mean(np.exp(1j * s[PSI]))) < 0.03


def test_directions_change_as_often_as_they_should():
    """Walkers that turned by more than a radian within a step: of the turns, the share 1 - 1 / pi."""
    s = particles(model=Walk(pause_s=1e-9))
    s[WALKING] = 1.0
    model = Walk(walk_s=1e9, heading_std=0.0)
    change = walk(model)(s, 0.5, np.random.default_rng(4))[PSI] - s[PSI]
    turned = np.abs(np.angle(np.exp(1j * change))) > 1.0
    expected = (1.0 - math.exp(-0.5 / 8.0)) * (1.0 - 1.0 / math.pi)
    assert turned.mean() == pytest.approx(expected, abs=5.0 * math.sqrt(expected / P))


def test_walkers_draw_a_new_speed_when_they_go_on():
    s = particles()
    s[WALKING], s[SPEED] = 0.0, 0.5
    new = walk(Walk(pause_s=1e-9))(s, 0.5, np.random.default_rng(5))
    assert new[WALKING].all()
    assert new[SPEED].mean() == pytest.approx(1.25, abs=0.02)


def test_what_is_drawn_is_anywhere():
    s = particles(3)
    assert s.shape == (3, STATES, P)
    assert np.hypot(s[:, VX], s[:, VY]).max() <= 2.0
    still = drawn(Walk(v_min=0.0, v_max=0.0, pause_s=0.0, yaw_std=0.0), s[:, :2], np.random.default_rng(1))
    assert not still[:, [VX, VY, YAW]].any()
    assert still[:, WALKING].all()


def test_reflection_stays_within():
    v = np.array([-5.0, 0.3, 0.5, 1.0, 2.0, 2.2, 9.0])
    np.testing.assert_allclose(within(v, 0.5, 2.0), [0.5, 0.7, 0.5, 1.0, 2.0, 1.8, 0.5])


def test_who_would_leave_stays_and_turns():
    s = particles(2)
    new = s.copy()
    new[:, X] += 30.0
    area = (0.0, 0.0, 100.0, 100.0)
    out = beyond(new, area)
    np.testing.assert_array_equal(out, new[:, X] > 100.0)
    after = kept(s, new, out, np.random.default_rng(6))
    assert not beyond(after, area).any()
    expected = np.where(out[:, None], s[:, : Y + 1], new[:, : Y + 1])
    np.testing.assert_array_equal(after[:, : Y + 1], expected)
    assert np.mean(after[:, PSI][out] == new[:, PSI][out]) < 0.01
    np.testing.assert_array_equal(after[:, PSI][~out], new[:, PSI][~out])
    assert kept(s, s, beyond(s, area), np.random.default_rng(6)) is s
