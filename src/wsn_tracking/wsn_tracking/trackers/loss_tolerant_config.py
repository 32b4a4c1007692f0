"""Parameters of system E: one filter that tolerates the loss of packets."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.region import region_of
from wsn_tracking.parameters import group, param
from wsn_tracking.trackers.random_q_config import StartConfig

LEAST_KAPPA = -2.0  # 3 - n with n = 5 states; below, the rule over the states that matter has no covariance


@dataclass(frozen=True)
class TurnConfig:
    """The coordinated turn and its noise."""

    acceleration_std: float = param(0.4, 'sv: an acceleration that lasts from epoch to epoch', 'm/s^2', 0.0, 1e3)
    turn_std: float = param(1.5, 'sw: random walk of the turn rate in one second', 'deg/s', 0.0, 360.0)
    horizon: float = param(30.0, 'a prediction goes no further beyond what was heard last', 's', 1e-3, 1e6)


@dataclass(frozen=True)
class RangeConfig:
    """Noise of what does not tell its own."""

    range_std: float = param(0.1, 'ranges that tell neither variance nor come from RSSI', 'm', 1e-6, 1e3)


@dataclass(frozen=True)
class GateConfig:
    """Readings that cannot be the target's."""

    gate: float = param(0.0, 'readings further from their prediction are left out; 0: none', 'std', 0.0, 1e6)


@dataclass(frozen=True)
class RestartConfig:
    """When a track is given up and found anew from what is heard next."""

    silence: float = param(30.0, 'nothing usable heard for longer: start anew; 0: never', 's', 0.0, 1e6)
    rejects: int = param(10, 'epochs in a row with most readings gated: start anew; 0: never', '', 0, 10000)


@dataclass(frozen=True)
class TurningStartConfig(StartConfig):
    """First belief."""

    epochs: int = param(4, 'likelihood: epochs with measurements that it takes', '', 1, 100)
    speed: float = param(3.0, 'standard deviation of the velocity per axis', 'm/s', 1e-3, 100.0)
    turn: float = param(3.0, 'standard deviation of the turn rate', 'deg/s', 1e-3, 360.0)
    std: tuple[float, ...] = param((5.0, 5.0, 2.0, 2.0), 'given: their standard deviations', 'm and m/s', 1e-6)


@dataclass(frozen=True)
class LossTolerantConfig:
    """The tracker of system E."""

    filter: str = param(
        'ckf',
        'ckf: cubature (the document); ekf, ukf: its comparisons; hold: ckf that takes the last value for a lost one',
        choices=('ckf', 'ekf', 'ukf', 'hold'),
    )
    kappa: float = param(LEAST_KAPPA, 'ukf: of its points, 3 - n; 0 is ckf', '', LEAST_KAPPA, 100.0)
    area: tuple[float, ...] = param(
        (), 'that positions are kept in: x_min, y_min, x_max, y_max, or x, y of each corner; empty: not kept', 'm'
    )
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)
    channel: str = param(
        '', 'file of `calibrate` with the radios of the nodes and, for signal strengths, their map; empty: the anchors'
    )
    turn: TurnConfig = group(TurnConfig)
    update: RangeConfig = group(RangeConfig)
    robust: GateConfig = group(GateConfig)
    reacquire: RestartConfig = group(RestartConfig)
    start: TurningStartConfig = group(TurningStartConfig)

    def checked(self) -> LossTolerantConfig:
        """Itself, or TrackingError where fields contradict each other."""
        if self.area:
            region_of(tuple(self.area))
        if len(self.start.mean) != 4 or len(self.start.std) != 4:
            raise TrackingError('`start.mean` and `start.std` take four numbers each: x, y, vx, vy')
        if self.turn.acceleration_std == 0.0:
            raise TrackingError('`turn.acceleration_std` is 0: without process noise a filter stops listening')
        return self
