"""Parameters of system D."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.region import region_of
from wsn_tracking.parameters import group, param

Checked = TypeVar('Checked', bound='HybridConfig')
FORMS = ('inflate', 'decay', 'literal', 'imm', 'ekf')


@dataclass(frozen=True)
class MotionConfig:
    """How targets move between ranges."""

    spectral_density: float = param(0.01, 'q_w: of the white acceleration', 'm^2/s^3', 0.0, 1e6)
    velocity_time: float = param(
        0.0, 'after which a velocity is forgotten, for targets with long gaps; 0: it is kept', 's', 0.0, 1e6
    )


@dataclass(frozen=True)
class RobustConfig:
    """Ranges that are not what they say."""

    gate: float = param(6.0, 'ranges further from their prediction are left out; 0: none', 'std', 0.0, 1e6)
    rejects: float = param(
        0.6, 'share of gated ranges, mean over some 16, from which on the target is looked for elsewhere; 1: never',
        '', 0.01, 1.0,
    )  # fmt: skip
    misfit: float = param(6.0, 'likewise for nu^2 / S of ranges that were used; 0: never', '', 0.0, 1e6)
    dof: float = param(
        0.0, 'degrees of freedom of Student-t noise (3 heavy, 30 light tails); 0: Gaussian', '', 0.0, 1e6
    )


@dataclass(frozen=True)
class LeastSquaresConfig:
    """Least squares of the latest ranges, low-passed (inflate, decay, literal)."""

    age_max: float = param(7.0, 'oldest range that it takes', 'periods', 0.0, 1e6)
    weight: float = param(0.5, 'a: share of the newest position in the low pass', '', 1e-3, 1.0)


@dataclass(frozen=True)
class ManoeuvreConfig:
    """When a manoeuvre is found, and what is done (inflate, decay, literal)."""

    length: int = param(4, 'innovations that are summed; none counts for more than half', 'ranges', 3, 1000)
    threshold: float = param(18.5, 'of the sum of nu^2 / S: one in a thousand for four', '', 0.0, 1e6)
    rest: int = param(12, 'ranges from one manoeuvre to the next, at least', 'ranges', 0, 100000)
    fresh: float = param(4.0, 'least squares counts of ranges no older, and there for so long', 'periods', 0.0, 1e6)
    position_std: float = param(0.02, 'least error of least squares that is allowed for', 'm', 1e-6, 1e3)
    velocity_std: float = param(0.2, 'likewise of its velocity', 'm/s', 1e-6, 1e3)
    decay: float = param(0.85, 'lambda: the extra gain fades by it with each range (decay, literal)', '', 0.0, 1.0)


@dataclass(frozen=True)
class ModelsConfig:
    """The two models of form imm."""

    spectral_density: float = param(0.003, 'of the white acceleration, before the factors', 'm^2/s^3', 0.0, 1e6)
    calm: float = param(0.2, 'factor of the first model', '', 0.0, 1e6)
    brisk: float = param(40.0, 'factor of the second model', '', 0.0, 1e6)
    stay_calm: float = param(0.95, 'probability of staying in the first model for a period', '', 0.0, 1.0)
    stay_brisk: float = param(0.9, 'likewise in the second', '', 0.0, 1.0)


@dataclass(frozen=True)
class StartConfig:
    """Where a track begins, and begins anew."""

    kind: str = param(
        'auto',
        'ls: least squares; hypotheses: several places at once until one is left; auto: these where fewer than three '
        'nodes are heard in the window',
        choices=('auto', 'ls', 'hypotheses'),
    )
    window: float = param(0.5, 'ls: oldest range that it takes', 's', 1e-3, 1e6)
    misfit: float = param(5.0, 'ls: ranges that are no further from what it finds agree with it', 'std', 0.1, 1e6)
    majority: float = param(0.6, 'ls: share of the ranges that must agree', '', 0.0, 1.0)
    position_std: float = param(0.2, 'ls: root of P0 in position, per axis (the document: 1)', 'm', 1e-6, 1e4)
    velocity_std: float = param(0.5, 'root of P0 in velocity, per axis (the document: 1)', 'm/s', 1e-6, 1e3)
    resolved: float = param(
        0.3, 'hypotheses: a track begins below this standard deviation of the position', 'm', 0.0, 1e4
    )
    most: int = param(60, 'hypotheses: kept at most', '', 2, 10000)

    @property
    def P0(self) -> Floats:
        """Covariance (4, 4) of a track that least squares has begun."""
        return np.diag(np.square([self.position_std, self.position_std, self.velocity_std, self.velocity_std]))


@dataclass(frozen=True)
class HybridConfig:
    """One tracker of system D: one target."""

    form: str = param(
        'inflate',
        'what answers a manoeuvre. inflate: P grows by what least squares says; decay: an extra gain that fades; '
        'literal: the document, for simultaneous ranges alone; imm: two models at once; ekf: nothing',
        choices=FORMS,
    )
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)
    area: tuple[float, ...] = param(
        (),
        'where targets are looked for: x_min, y_min, x_max, y_max, or corners x, y, ...; empty: round the nodes',
        'm',
    )
    period: float = param(0.05, 'T: time between ranges of a target', 's', 1e-4, 3600.0)
    range_std: float = param(0.02, 'of ranges that tell neither variance nor come from RSSI', 'm', 1e-6, 1e3)
    stale: float = param(
        1.0, 'without a usable range for so long, four periods at least, a track is found anew', 's', 1e-3, 1e6
    )
    channel: str = param('', 'file of `calibrate` with the radios of the nodes; empty: the anchors tell')
    motion: MotionConfig = group(MotionConfig)
    robust: RobustConfig = group(RobustConfig)
    least_squares: LeastSquaresConfig = group(LeastSquaresConfig)
    manoeuvre: ManoeuvreConfig = group(ManoeuvreConfig)
    models: ModelsConfig = group(ModelsConfig)
    start: StartConfig = group(StartConfig)

    def checked(self: Checked) -> Checked:
        """Itself, or TrackingError where fields contradict each other."""
        if self.area:
            region_of(tuple(self.area))
        if self.form != 'imm' and self.motion.spectral_density == 0.0:
            raise TrackingError('`motion.spectral_density` is 0: without process noise a filter stops listening')
        if self.form == 'imm' and not 0.0 < self.models.calm < self.models.brisk:
            raise TrackingError(
                f'`models.calm` is {self.models.calm:g} and `models.brisk` {self.models.brisk:g}: '
                'expected 0 < calm < brisk'
            )
        return self
