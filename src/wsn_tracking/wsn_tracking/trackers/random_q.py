"""System A: random-Q square-root cubature Kalman filters (seed 000, section 2.1), one an estimator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from typing_extensions import Self

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters import srckf
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.start import Area, Sight, area_of, likelihood_start
from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.measurement import (
    Function,
    constant_noise,
    log_range_function,
    range_function,
    rssi_function,
)
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import scaled_identity, white_acceleration
from wsn_tracking.models.radio import relative_range_std
from wsn_tracking.parameters import group, param
from wsn_tracking.sensing.average import usable
from wsn_tracking.sensing.values import Epoch, Modality, Range, Rssi
from wsn_tracking.trackers.estimate import Estimate, Kind

ESTIMATORS = 2**33  # estimators draw from streams of their own: ESTIMATORS + number; sensing nodes from that of their id


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


@dataclass(frozen=True)
class UpdateConfig:
    """Measurement update."""

    kind: str = param(
        'ckf',
        'ckf: the document; iplf: iterated posterior linearisation; log: iplf on ln(range)',
        choices=('ckf', 'iplf', 'log'),
    )
    passes: int = param(3, 'iplf and log: regressions an update', '', 1, 20)
    range_std: float = param(0.1, 'ranges that tell neither variance nor come from RSSI', 'm', 1e-6, 1e3)
    r: str = param(
        'predicted',
        'RSSI ranges: noise at the predicted range, or at the measured one (the document)',
        choices=('predicted', 'measured'),
    )


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
    area: tuple[float, ...] = param((), 'x_min, y_min, x_max, y_max that positions are kept in; empty: not kept', 'm')
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)
    noise: NoiseConfig = group(NoiseConfig)
    update: UpdateConfig = group(UpdateConfig)
    start: StartConfig = group(StartConfig)

    def checked(self) -> Self:
        """Itself, or TrackingError where fields contradict each other."""
        if self.noise.q_max < self.noise.q_min:
            raise TrackingError(f'`noise.q_max` {self.noise.q_max:g} is below `noise.q_min` {self.noise.q_min:g}')
        if self.noise.q_max == 0.0:
            raise TrackingError('`noise.q_max` is 0: without process noise a filter stops listening')
        if self.area and not (len(self.area) == 4 and self.area[0] < self.area[2] and self.area[1] < self.area[3]):
            raise TrackingError(f'`area` is {list(self.area)}: expected x_min, y_min, x_max, y_max with min < max')
        if len(self.start.mean) != 4 or len(self.start.std) != 4:
            raise TrackingError('`start.mean` and `start.std` take four numbers each: x, y, vx, vy')
        return self


def process_root(config: NoiseConfig, q: Floats, dt: float) -> Floats:
    """chol_Q (..., 4, 4) for drawn q (...) and a step of dt [s]; zero for dt = 0."""
    if dt <= 0.0:
        return np.zeros((*np.shape(q), 4, 4))
    if config.kind == 'identity':
        return scaled_identity(q)
    factor = 2.0 * np.asarray(q) / (config.q_min + config.q_max)
    return factor[..., None, None] * white_acceleration(config.spectral_density, dt)


def random_q_step(
    belief: Belief,
    dt: float,
    q: Floats,
    z: Floats,
    h: Function,
    noise: Function,
    config: RandomQConfig,
) -> Belief:
    """Algorithm 1 of seed 000: predict by dt [s] with the drawn q (...), update with z (..., N), keep inside."""
    predicted = srckf.predict(belief, constant_velocity(dt), process_root(config.noise, q, dt))
    passes = 1 if config.update.kind == 'ckf' else config.update.passes
    return keep_inside(srckf.update(predicted, z, h, noise, passes), config.area)


def keep_inside(belief: Belief, area: tuple[float, ...]) -> Belief:
    """The belief with its position clipped to the area (x_min, y_min, x_max, y_max), where there is one."""
    if not area:
        return belief
    low, high = np.array([*area[:2], -np.inf, -np.inf]), np.array([*area[2:], np.inf, np.inf])
    return belief._replace(m=np.clip(belief.m, low, high))


class MeasurementTable:
    """From an epoch's measurements to z, h and noise over all nodes (seed 000, algorithm 1, steps 4 to 6)."""

    def __init__(self, anchors: Anchors, height: float, update: UpdateConfig) -> None:
        self.anchors = anchors
        self._range = range_function(anchors, height)
        self._log_range = log_range_function(anchors, height)
        self._rssi = rssi_function(anchors, height)
        self._update = update

    def read(self, epoch: Epoch) -> tuple[Floats, Function, Function, tuple[int, ...]]:
        """z (N,) with NaN where nothing usable was heard, h, noise root, and the nodes that were used."""
        packets = [p for p in epoch.measurements if isinstance(p, (Range, Rssi)) and usable(p)]
        rows = self.anchors.rows([p.node_id for p in packets]).tolist()
        kept = [(row, p) for row, p in zip(rows, packets, strict=True) if row >= 0]
        ids = tuple(p.node_id for _, p in kept)
        z = np.full(self.anchors.ids.size, np.nan)
        if kept and isinstance(kept[0][1], Rssi):
            std = self.anchors.sigma_db.copy()
            for row, p in kept:
                if isinstance(p, Rssi):
                    z[row] = p.rssi_dbm
                    std[row] = std[row] if np.isnan(p.sigma_db) else p.sigma_db
            return z, self._rssi, constant_noise(std), ids
        variance = np.full(z.size, np.nan)
        for row, p in kept:
            if isinstance(p, Range):
                z[row], variance[row] = p.range, p.variance
        from_rssi = bool(kept) and all(isinstance(p, Range) and p.modality == Modality.RSSI for _, p in kept)
        return *self.ranges(z, np.sqrt(variance), from_rssi), ids

    def ranges(self, z: Floats, told: Floats, from_rssi: bool) -> tuple[Floats, Function, Function]:
        """What the filter updates with, h and noise root, for ranges z and told noise roots, both (..., N) [m].

        NaN in z: not heard; in `told`: not known. A range from RSSI has an error that grows with it; any other has
        the one that came along.
        """
        h = self._range
        default = relative_range_std(self.anchors) * z if from_rssi else self._update.range_std
        std = np.where(np.isnan(told), default, told)
        if self._update.kind == 'log':
            return np.log(z), self._log_range, constant_noise(std / z)
        if from_rssi and self._update.r == 'predicted':
            share = std / z
            return z, h, lambda x: share[..., None, :] * h(x)
        return z, h, constant_noise(std)


class LocalEstimator:
    """Estimator `number` of system A: one `step` an epoch, whatever was heard."""

    def __init__(self, config: RandomQConfig, anchors: Anchors, number: int) -> None:
        self.config = config.checked()
        self.number = number
        self.table = MeasurementTable(anchors, config.target_height, config.update)
        self._area: Area = (*config.area,) if config.area else area_of(anchors)  # type: ignore[assignment]
        self.reset()

    def reset(self) -> None:
        """Forget the past: as after a start."""
        start = self.config.start
        self._sights: list[tuple[int, Sight]] = []
        self._starting = start.kind == 'likelihood'
        self._belief = Belief(np.array(start.mean), np.diag(np.array(start.std)))
        self._stamp_ns: int | None = None

    def draw(self, epoch: int) -> float:
        """q ~ U[q_min, q_max] of this estimator in that epoch."""
        noise = self.config.noise
        return float(keyed(self.config.seed, ESTIMATORS + self.number, epoch).uniform(noise.q_min, noise.q_max))

    def step(self, epoch: Epoch) -> Estimate:
        """Predict to the epoch and update with what it holds; an empty epoch predicts."""
        z, h, noise, used = self.table.read(epoch)
        q = self.draw(epoch.request_seq)
        if self._starting:
            belief, kind = self._find_start(epoch.stamp_ns, Sight(0.0, z, h, noise), bool(used)), Kind.START
        else:
            dt = 0.0 if self._stamp_ns is None else max(epoch.stamp_ns - self._stamp_ns, 0) * 1e-9
            belief = random_q_step(self._belief, dt, np.asarray(q), z, h, noise, self.config)
            kind = Kind.LOCAL
        self._belief, self._stamp_ns = belief, epoch.stamp_ns
        return Estimate(
            epoch.stamp_ns,
            epoch.target_id,
            epoch.request_seq,
            f'local_{self.number}',
            belief.m,
            belief.P,
            (self.number,),
            used,
            q,
            kind,
        )

    def _find_start(self, stamp_ns: int, sight: Sight, heard: bool) -> Belief:
        """The likelihood over the area of all that was heard so far; ends with the epoch that completes it."""
        start = self.config.start
        if heard:
            self._sights.append((stamp_ns, sight))
        aged = [s._replace(age=(stamp_ns - then) * 1e-9) for then, s in self._sights]
        belief = likelihood_start(aged, self._area, start.speed)
        self._starting = len(self._sights) < start.epochs
        return keep_inside(belief, self.config.area)

    def feed_back(self, fused: Estimate) -> None:
        """Go on from a fused estimate instead of one's own (option `feedback`)."""
        self._belief = Belief(fused.mean, np.linalg.cholesky(fused.covariance))
