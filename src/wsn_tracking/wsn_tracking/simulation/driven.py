"""A wheeled robot that keeps in phase with another one, by what it is told of both (seed 001, its second experiment).

The first robot goes round its circle at an angular speed that varies. The second one hears, over the network, where
both are seen, and turns round its own circle so that both angles agree. The document names no controller: this one is
a phase-locked loop, with a course that leads back to the circle. Its functions take any leading axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.motion import coordinated_turn
from wsn_tracking.models.range_bearing import wrapped
from wsn_tracking.parameters import param

FIRST, SECOND = 1, 2  # target ids of the robots
CONTROL_S = 0.02  # [s] the wheels are set anew so often
MEMORY_S = 1.0  # [s] for which the sum of errors goes on after a feedback


@dataclass(frozen=True)
class FollowConfig:
    """The two circles, and the controller of the second robot."""

    first_centre: tuple[float, ...] = param((1.0, 5.0), "middle of the first robot's circle", 'm')
    centre: tuple[float, ...] = param((2.0, 2.0), "middle of the second robot's circle", 'm')
    radius: float = param(1.0, "of the second robot's circle", 'm', 1e-3, 1e3)
    phase_gain: float = param(1.5, 'angular speed for an error in phase', '1/s', 0.0, 100.0)
    rate_gain: float = param(0.6, 'how fast the angular speed of the first is learnt', '1/s^2', 0.0, 100.0)
    radial_gain: float = param(2.0, 'turn of the course for an error in radius', 'rad/m', 0.0, 100.0)
    heading_gain: float = param(3.0, 'turn for an error in course', '1/s', 0.0, 100.0)
    most_speed: float = param(1.2, 'of the robot', 'm/s', 1e-3, 100.0)
    patience: float = param(1.0, 'a robot that is told nothing for longer stops', 's', 1e-3, 1e3)


class Wheels(NamedTuple):
    """What the robot does."""

    v: Floats  # (...) [m/s] ahead
    w: Floats  # (...) [rad/s] to the left


def phase(position: Floats, centre: tuple[float, ...]) -> Floats:
    """Angle (...) [rad] of positions (..., 2) [m] about the middle of a circle, from the east, counter-clockwise."""
    angle: Floats = np.arctan2(position[..., 1] - centre[1], position[..., 0] - centre[0])
    return angle


def phase_error(config: FollowConfig, first: Floats, second: Floats) -> Floats:
    """How far the second robot is behind the first (...) [rad], for positions (..., 2) [m]."""
    return wrapped(phase(first, config.first_centre) - phase(second, config.centre))


def learnt(config: FollowConfig, rate: Floats, error: Floats, dt: Floats) -> Floats:
    """What the second robot believes of the first's angular speed (...) [rad/s], dt [s] after the last feedback."""
    fastest = config.most_speed / config.radius
    return np.clip(rate + config.rate_gain * error * np.minimum(dt, MEMORY_S), -fastest, fastest)


def wheels(config: FollowConfig, rate: Floats, error: Floats, position: Floats, heading: Floats) -> Wheels:
    """What the second robot does at a position (..., 2) [m] and heading (...) [rad].

    It goes round at the first's angular speed and the more for what it is behind, never backwards; its course is the
    tangent of its circle, turned inwards as far as it is outside.
    """
    fastest = config.most_speed / config.radius
    turning = np.clip(rate + config.phase_gain * error, 0.0, fastest)
    r = np.hypot(position[..., 0] - config.centre[0], position[..., 1] - config.centre[1])
    course = phase(position, config.centre) + 0.5 * np.pi + np.arctan(config.radial_gain * (r - config.radius))
    return Wheels(turning * config.radius, turning + config.heading_gain * wrapped(course - heading))


def moved(state: Floats, drive: Wheels, dt: float) -> Floats:
    """Position and heading (..., 3) [m, rad] after dt [s] of a drive: an arc."""
    heading = state[..., 2]
    turning = np.stack(
        np.broadcast_arrays(
            state[..., 0], state[..., 1], drive.v * np.cos(heading), drive.v * np.sin(heading), drive.w
        ),
        axis=-1,
    )
    after = coordinated_turn(turning, dt)
    return np.stack([after[..., 0], after[..., 1], wrapped(heading + drive.w * dt)], axis=-1)


class DrivenRobot:
    """The second robot: it is told where both are seen, and drives; times are of one steady clock [s].

    Between two feedbacks it counts its own way (odometry) and lets the first go on at the speed that it has learnt. It
    knows its heading.
    """

    def __init__(self, config: FollowConfig, angle: float, t: float = 0.0) -> None:
        """It stands on its circle at an angle [rad], and looks along the tangent."""
        self.config = config
        c, s = np.cos(angle), np.sin(angle)
        middle = np.array(config.centre)
        self._at = np.array([*(middle + config.radius * np.array([c, s])), wrapped(angle + 0.5 * np.pi)])
        self._t = t
        self._rate: Floats = np.zeros(())
        self._drive = Wheels(np.zeros(()), np.zeros(()))
        self._first: tuple[float, float] | None = None  # when the first was told, and its phase
        self._offset: Floats | None = None  # from where it believes to be to where it was told, less its way since

    @property
    def state(self) -> Floats:
        """Where it really is, [x, y, vx, vy]."""
        x, y, heading = self._at
        return np.array([x, y, self._drive.v * np.cos(heading), self._drive.v * np.sin(heading)])

    def hear(self, target_id: int, position: Floats, t: float) -> None:
        """Where either robot is seen (2,) [m]; others are none of its business."""
        if target_id == FIRST:
            self.hear_first(position, t)
        elif target_id == SECOND:
            self.hear_own(position, t)

    def hear_own(self, position: Floats, t: float) -> None:
        """Where it is seen itself (2,) [m]."""
        self.advance(t)
        self._offset = np.asarray(position) - self._at[:2]

    def hear_first(self, position: Floats, t: float) -> None:
        """Where the first robot is seen (2,) [m]."""
        self.advance(t)
        told = float(phase(np.asarray(position), self.config.first_centre))
        if self._offset is not None:
            dt = t - self._first[0] if self._first else 0.0
            error = wrapped(told - phase(self._believed, self.config.centre))
            self._rate = learnt(self.config, self._rate, error, np.asarray(dt))
        self._first = (t, told)

    def advance(self, t: float) -> None:
        """Drive until t."""
        while self._t < t:
            dt = min(CONTROL_S, t - self._t)
            self._drive = self._decided()
            self._at = moved(self._at, self._drive, dt)
            self._t += dt

    @property
    def _believed(self) -> Floats:
        assert self._offset is not None
        return np.asarray(self._at[:2] + self._offset)

    def _decided(self) -> Wheels:
        if self._first is None or self._offset is None or self._t - self._first[0] > self.config.patience:
            return Wheels(np.zeros(()), np.zeros(()))
        since, told = self._first
        error = wrapped(told + self._rate * (self._t - since) - phase(self._believed, self.config.centre))
        return wheels(self.config, self._rate, error, self._believed, self._at[2])
