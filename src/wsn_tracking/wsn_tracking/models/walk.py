"""How a person may have moved since the last epoch: three transition models of particles (seed 003, section 3.2).

Particles are columns, states are rows: position, velocity, walking direction and speed (which are kept while he
pauses), how far the body is turned away from that direction, and whether he walks at all. Rows behind these are the
caller's own and are kept.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats, Mask

X, Y, VX, VY, PSI, SPEED, YAW, WALKING = range(8)
STATES = 8
PLANAR = slice(VY + 1)  # what an estimate tells
TURN = 2.0 * math.pi
LEAST_TIME = 0.1  # [s]

Transition = Callable[[Floats, float, np.random.Generator], Floats]


class Disc(NamedTuple):
    """Anywhere within v_max dt of where he was (seed 003, eq. 11); the direction is that of the step."""

    v_max: float = 4.0  # [m/s] sets lag against noise: about 2 s1 v / v_max, s1 the deviation of a single epoch's fix


class RandomWalk(NamedTuple):
    """A step of N(0, std^2 dt) per axis."""

    std: float = 0.6  # [m / sqrt s]
    faces: bool = True  # the direction is that of the step; else nobody asks for it


class Walk(NamedTuple):
    """Legs with a direction and a speed, and pauses between them."""

    v_min: float = 0.5  # [m/s]
    v_max: float = 2.0  # [m/s]
    walk_s: float = 30.0  # mean time until he stops
    pause_s: float = 5.0  # mean time until he goes on
    turn_s: float = 8.0  # mean time until he turns to another direction, any
    heading_std: float = 0.25  # [rad / sqrt s]
    speed_std: float = 0.25  # [m/s / sqrt s]
    position_std: float = 0.05  # [m / sqrt s]
    yaw_std: float = 0.6  # [rad] of the body against the walking direction
    yaw_s: float = 10.0  # correlation time of that


def disc(model: Disc) -> Transition:
    """Transition of a `Disc`; a step of no time keeps the direction."""

    def moved(s: Floats, dt: float, generator: np.random.Generator) -> Floats:
        if dt <= 0.0:
            return s
        new, shape = s.copy(), s[..., X, :].shape
        r = model.v_max * dt * np.sqrt(generator.random(shape))
        angle = TURN * generator.random(shape)
        new[..., PSI, :] = angle
        _step(new, r * np.cos(angle), r * np.sin(angle), dt)
        return new

    return moved


def random_walk(model: RandomWalk) -> Transition:
    """Transition of a `RandomWalk`."""

    def moved(s: Floats, dt: float, generator: np.random.Generator) -> Floats:
        if dt <= 0.0:
            return s
        new = s.copy()
        step = (model.std * math.sqrt(dt)) * generator.standard_normal((*s.shape[:-2], 2, s.shape[-1]))
        _step(new, step[..., 0, :], step[..., 1, :], dt)
        if model.faces:
            new[..., PSI, :] = np.arctan2(step[..., 1, :], step[..., 0, :])
        return new

    return moved


def walk(model: Walk) -> Transition:
    """Transition of a `Walk`. dt is taken in one step: it should be short against the mean times."""

    def moved(s: Floats, dt: float, generator: np.random.Generator) -> Floats:
        if dt <= 0.0:
            return s
        new, root = s.copy(), math.sqrt(dt)
        normal = generator.standard_normal((*s.shape[:-2], 5, s.shape[-1]))
        uniform = generator.random((*s.shape[:-2], 4, s.shape[-1]))
        walked = s[..., WALKING, :] > 0.0
        change = np.where(walked, -math.expm1(-dt / model.walk_s), -math.expm1(-dt / model.pause_s))
        walks = walked ^ (uniform[..., 0, :] < change)
        starts = walks & ~walked
        turns = starts | (uniform[..., 1, :] < -math.expm1(-dt / model.turn_s))
        psi = s[..., PSI, :] + (model.heading_std * root) * normal[..., 0, :] * walks
        v: Floats = s[..., SPEED, :] + (model.speed_std * root) * normal[..., 1, :]
        np.copyto(psi, TURN * uniform[..., 2, :], where=turns & walks)
        np.copyto(v, model.v_min + (model.v_max - model.v_min) * uniform[..., 3, :], where=starts)
        v = within(v, model.v_min, model.v_max)
        a = math.exp(-dt / model.yaw_s)
        new[..., YAW, :] = a * s[..., YAW, :] + model.yaw_std * math.sqrt(1.0 - a * a) * normal[..., 2, :]
        way = v * walks
        v_x, v_y = way * np.cos(psi), way * np.sin(psi)
        new[..., X, :] += v_x * dt + (model.position_std * root) * normal[..., 3, :]
        new[..., Y, :] += v_y * dt + (model.position_std * root) * normal[..., 4, :]
        new[..., VX, :], new[..., VY, :] = v_x, v_y
        new[..., PSI, :], new[..., SPEED, :], new[..., WALKING, :] = psi, v, walks
        return new

    return moved


def _step(s: Floats, step_x: Floats, step_y: Floats, dt: float) -> None:
    """Take a step in place; the velocity is that over LEAST_TIME at least: a diffusion has none at an instant."""
    s[..., X, :] += step_x
    s[..., Y, :] += step_y
    np.divide(step_x, max(dt, LEAST_TIME), out=s[..., VX, :])
    np.divide(step_y, max(dt, LEAST_TIME), out=s[..., VY, :])


def within(v: Floats, low: float, high: float) -> Floats:
    """v reflected at both bounds once, and clipped where that is not enough."""
    v = np.where(v < low, 2.0 * low - v, v)
    v = np.where(v > high, 2.0 * high - v, v)
    return np.asarray(np.clip(v, low, high))


def drawn(model: Walk, places: Floats, generator: np.random.Generator) -> Floats:
    """Particles (..., STATES, P) at places (..., 2, P) of which nothing else is known."""
    shape = (*places.shape[:-2], STATES, places.shape[-1])
    s = np.empty(shape)
    uniform = generator.random((*places.shape[:-2], 3, places.shape[-1]))
    s[..., : Y + 1, :] = places
    s[..., PSI, :] = TURN * uniform[..., 0, :]
    s[..., SPEED, :] = model.v_min + (model.v_max - model.v_min) * uniform[..., 1, :]
    s[..., YAW, :] = model.yaw_std * generator.standard_normal(uniform[..., 0, :].shape)
    s[..., WALKING, :] = uniform[..., 2, :] < model.walk_s / (model.walk_s + model.pause_s)
    v = s[..., SPEED, :] * s[..., WALKING, :]
    s[..., VX, :], s[..., VY, :] = v * np.cos(s[..., PSI, :]), v * np.sin(s[..., PSI, :])
    return s


def kept(before: Floats, after: Floats, out: Mask, generator: np.random.Generator) -> Floats:
    """Particles that are where nobody can be (..., P) stay where they were, and look for another direction."""
    if not out.any():
        return after
    after = after.copy()
    for row in (X, Y):  # the velocity, too, is that of another direction: it is known again after the next step
        np.copyto(after[..., row, :], before[..., row, :], where=out)
    np.copyto(after[..., PSI, :], TURN * generator.random(out.shape), where=out)
    return after


def beyond(s: Floats, area: tuple[float, float, float, float]) -> Mask:
    """Which particles (..., S, P) are outside the area x_min, y_min, x_max, y_max [m]."""
    x, y = s[..., X, :], s[..., Y, :]
    return np.asarray((x < area[0]) | (x > area[2]) | (y < area[1]) | (y > area[3]))
