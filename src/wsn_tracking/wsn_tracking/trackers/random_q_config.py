"""Parameters of system A's filters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.region import region_of
from wsn_tracking.parameters import group, param

Checked = TypeVar('Checked', bound='RandomQConfig')


@dataclass(frozen=True)
class NoiseConfig:
    """Process noise and how it is drawn anew in every epoch."""

    kind: str = param(
        'identity',
        'identity: S_Q = q I, valid for T = 1 s only; acceleration: white, its root scaled by 2 q / (q_min + q_max)',
        choices=('identity', 'acceleration'),
    )
    q_min: float = param(6.0, 'lower bound of the drawn q', 'cm and cm/s', 0.0, 1e6)
    q_max: float = param(8.0, 'upper bound of the drawn q', 'cm and cm/s', 0.0, 1e6)
    spectral_density: float = param(1.6e-3, 'acceleration: S', 'm^2/s^3', 0.0, 1e6)
    velocity_time: float = param(
        0.0, 'acceleration: after which a velocity is forgotten; 0: never (the document)', 's', 0.0, 1e6
    )


@dataclass(frozen=True)
class UpdateConfig:
    """Measurement update."""

    kind: str = param(
        'ckf',
        'ckf: the document; iplf: iterated posterior linearisation; log: iplf on ln(range)',
        choices=('ckf', 'iplf', 'log'),
    )
    passes: int = param(3, 'iplf and log: regressions an update', '', 1, 20)
    kappa: float = param(0.0, '0: cubature points; more: unscented points that look further out', '', 0.0, 100.0)
    range_std: float = param(0.1, 'ranges that tell neither variance nor come from RSSI', 'm', 1e-6, 1e3)
    r: str = param(
        'predicted',
        'RSSI ranges: noise at the predicted range, or at the measured one (the document)',
        choices=('predicted', 'measured'),
    )


@dataclass(frozen=True)
class RobustConfig:
    """What real radio needs beyond Gaussian white noise."""

    dof: float = param(
        0.0, 'degrees of freedom of Student-t noise (3 heavy, 30 light tails); 0: Gaussian', '', 0.0, 1e6
    )
    gate: float = param(0.0, 'readings further from their prediction are left out; 0: none', 'std', 0.0, 1e6)
    offset_std: float = param(0.0, 'of a drifting offset a link, part of its noise; 0: none', 'dB or m', 0.0, 1e3)
    offset_time: float = param(2.0, 'correlation time of the offsets', 's', 1e-3, 1e6)


@dataclass(frozen=True)
class ReacquireConfig:
    """When a track is given up and found anew from what was heard last."""

    silence: float = param(0.0, 'nothing usable heard for longer: start anew; 0: never', 's', 0.0, 1e6)
    rejects: int = param(0, 'epochs in a row with most readings gated: start anew; 0: never', '', 0, 10000)
    odds: float = param(
        0.0,
        'log odds with which what was heard within `window`, counted as one epoch, speaks for another place than '
        'the track: beyond, start there; 0: never',
        '',
        0.0,
        1e6,
    )
    window: float = param(3.0, 'how far back the new start looks', 's', 0.0, 1e6)


@dataclass(frozen=True)
class StartConfig:
    """First belief."""

    kind: str = param(
        'likelihood', 'likelihood: from the first epochs; given: mean and std', choices=('likelihood', 'given')
    )
    epochs: int = param(4, 'likelihood: epochs with measurements that it takes', '', 1, 100)
    speed: float = param(0.1, 'standard deviation of the velocity per axis', 'm/s', 1e-3, 100.0)
    mean: tuple[float, ...] = param((0.0, 0.0, 0.0, 0.0), 'given: x, y, vx, vy', 'm and m/s')
    std: tuple[float, ...] = param((0.1, 0.1, 0.06, 0.06), 'given: their standard deviations', 'm and m/s', 1e-6)


@dataclass(frozen=True)
class RandomQConfig:
    """One estimator of system A."""

    seed: int = param(0, 'of the random process noise; the draw is keyed by seed, estimator and epoch', '', 0)
    area: tuple[float, ...] = param(
        (), 'that positions are kept in: x_min, y_min, x_max, y_max, or x, y of each corner; empty: not kept', 'm'
    )
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)
    noise: NoiseConfig = group(NoiseConfig)
    update: UpdateConfig = group(UpdateConfig)
    robust: RobustConfig = group(RobustConfig)
    reacquire: ReacquireConfig = group(ReacquireConfig)
    start: StartConfig = group(StartConfig)

    def checked(self: Checked) -> Checked:
        """Itself, or TrackingError where fields contradict each other."""
        if self.noise.q_max < self.noise.q_min:
            raise TrackingError(f'`noise.q_max` {self.noise.q_max:g} is below `noise.q_min` {self.noise.q_min:g}')
        if self.noise.q_max == 0.0:
            raise TrackingError('`noise.q_max` is 0: without process noise a filter stops listening')
        if self.noise.kind == 'acceleration' and self.noise.spectral_density == 0.0:
            raise TrackingError('`noise.spectral_density` is 0: without process noise a filter stops listening')
        if self.noise.velocity_time and self.noise.kind != 'acceleration':
            raise TrackingError('`noise.velocity_time` belongs to white acceleration: set `noise.kind` to acceleration')
        if self.area:
            region_of(tuple(self.area))
        if len(self.start.mean) != 4 or len(self.start.std) != 4:
            raise TrackingError('`start.mean` and `start.std` take four numbers each: x, y, vx, vy')
        if self.reacquire.rejects and not self.robust.gate:
            raise TrackingError('`reacquire.rejects` counts gated readings: set `robust.gate` as well')
        return self
