"""Parameters of system C: the particle filter that tracks a person."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.resampling import RESAMPLERS
from wsn_tracking.models.body import LOS, NLOS, SINGLE
from wsn_tracking.models.body_likelihood import Kernel
from wsn_tracking.models.region import region_of
from wsn_tracking.parameters import group, param

Checked = TypeVar('Checked', bound='HumanConfig')
OF_PROFILE = -1.0  # a number that the profile sets
PROFILES: Mapping[str, Mapping[str, Any]] = {
    'improved': {
        'motion': 'walk',
        'signal': 'soft',
        'v_max': 4.0,
        'extra': 0.0,
        'outlier': 0.02,
        'draws': 10000,
        'reset': 2,
    },
    'paper_max': {
        'motion': 'disc',
        'signal': 'max',
        'v_max': 4.0,
        'extra': 0.0,
        'outlier': 0.0,
        'draws': 10000,
        'reset': 0,
    },
    'paper_direction': {
        'motion': 'disc',
        'signal': 'direction',
        'v_max': 2.0,
        'extra': 0.0,
        'outlier': 0.0,
        'draws': 10000,
        'reset': 0,
    },
    'rss_mcl': {
        'motion': 'disc',
        'signal': 'single',
        'v_max': 3.0,
        'extra': 5.6,
        'outlier': 0.0,
        'draws': 10000,
        'reset': 0,
    },
}


@dataclass(frozen=True)
class SignalConfig:
    """What a node should read."""

    kind: str = param(
        'profile',
        'soft: both curves, mixed by where the body faces; max: the likelier one (eq. 15); direction: the one on whose '
        'side he walks (eq. 13); single: one curve; profile: as `profile` says',
        choices=('profile', 'soft', 'max', 'direction', 'single'),
    )
    curves: str = param(
        'anchors',
        "anchors: LOS and NLOS lie about each node's own path loss as about the single curve here; given: as they are "
        'here, for every node',
        choices=('anchors', 'given'),
    )
    los: tuple[float, ...] = param(tuple(LOS), 'in front of the body: at 1 m, and per decade of distance', 'dBm and dB')
    nlos: tuple[float, ...] = param(tuple(NLOS), 'behind the body', 'dBm and dB')
    single: tuple[float, ...] = param(tuple(SINGLE), 'both in one', 'dBm and dB')
    body_loss: float = param(0.0, 'of every reading, by being worn: negative is loss', 'dB', -60.0, 60.0)
    least_distance: float = param(0.3, 'no node is nearer to the chest', 'm', 1e-3, 100.0)
    sigma: float = param(
        0.0, 'standard deviation of a reading; 0: as the packets tell, else the anchors', 'dB', 0.0, 100.0
    )
    extra: float = param(
        OF_PROFILE,
        'more deviation, added in squares, for what the curves leave out; -1: as `profile` says',
        'dB',
        -1.0,
        100.0,
    )
    dof: float = param(0.0, 'degrees of freedom of Student-t noise, 2 to 4 on real radio; 0: Gaussian', '', 0.0, 1e6)
    outlier: float = param(
        OF_PROFILE, 'share of readings that say nothing (uniform over 60 dB); -1: as `profile` says', '', -1.0, 0.9
    )
    offset_std: float = param(
        0.0,
        'standard deviation of what a link reads too much or too little for a while, 2 to 3 dB on real radio; 0: none; '
        'for one curve (`signal.kind` single)',
        'dB',
        0.0,
        100.0,
    )
    offset_time: float = param(4.0, 'correlation time of that', 's', 1e-3, 1e6)
    sharpness: float = param(2.0, 'soft: k, how sharply a body shades', '', 0.0, 50.0)
    least_share: float = param(0.1, 'soft: eps, how often a node ahead is shaded, and one behind is not', '', 1e-3, 0.5)


@dataclass(frozen=True)
class MotionConfig:
    """How he may have moved."""

    kind: str = param(
        'profile',
        'walk: legs, pauses and a body that turns; random_walk: steps without memory; disc: anywhere within v_max dt '
        '(the document); profile: as `profile` says',
        choices=('profile', 'walk', 'random_walk', 'disc'),
    )
    v_max: float = param(
        OF_PROFILE,
        "disc: sets lag against noise, some 2 to 4 x the walker's speed; -1: as `profile` says",
        'm/s',
        -1.0,
        100.0,
    )
    step: float = param(0.6, 'random_walk: standard deviation per axis', 'm/sqrt(s)', 1e-3, 100.0)
    slowest: float = param(0.5, 'walk: of somebody who walks', 'm/s', 0.0, 100.0)
    fastest: float = param(2.0, 'walk: of somebody who walks', 'm/s', 1e-3, 100.0)
    walk_time: float = param(30.0, 'walk: mean time until he pauses', 's', 1e-3, 1e9)
    pause_time: float = param(5.0, 'walk: mean time until he goes on', 's', 1e-3, 1e9)
    turn_time: float = param(8.0, 'walk: mean time until he takes another direction, any', 's', 1e-3, 1e9)
    heading_noise: float = param(0.25, 'walk: of the direction', 'rad/sqrt(s)', 0.0, 100.0)
    speed_noise: float = param(0.25, 'walk: of the speed', 'm/s/sqrt(s)', 0.0, 100.0)
    position_noise: float = param(0.05, 'walk: of the position', 'm/sqrt(s)', 0.0, 100.0)
    yaw: float = param(0.6, 'walk: standard deviation of the body against the walking direction', 'rad', 0.0, 10.0)
    yaw_time: float = param(10.0, 'walk: correlation time of that', 's', 1e-3, 1e9)


@dataclass(frozen=True)
class ResamplingConfig:
    """When particles are drawn anew, how, and how many."""

    kind: str = param('systematic', 'how copies are drawn', choices=tuple(RESAMPLERS))
    threshold: float = param(0.5, 'drawn anew when N_eff is below this share of the particles', '', 0.0, 1.0)
    inverted: bool = param(False, 'when N_eff is above it, as the document prints: for comparison alone')
    kld: float = param(0.0, 'number of particles by KLD sampling with this error; 0: it stays', '', 0.0, 1.0)
    kld_cell: float = param(0.5, 'KLD: side of a cell', 'm', 1e-3, 1e3)
    kld_least: int = param(100, 'KLD: never fewer particles', '', 1, 1000000)
    kld_most: int = param(5000, 'KLD: never more', '', 1, 1000000)


@dataclass(frozen=True)
class StartConfig:
    """Where the particles come from, at first and when they have lost him."""

    draws: int = param(
        -1,
        'places weighed by the first epoch that is heard; 0: all particles anywhere; -1: as `profile` says, which is '
        '10 000 in all of them: of a few hundred that begin anywhere, those in the right place may face the wrong way, '
        'and die',
        '',
        -1,
        1000000,
    )
    gap: float = param(60.0, 'time without an epoch after which he may be anywhere', 's', 1e-3, 1e9)
    silence: float = param(
        20.0, 'time without a reading after which particles are drawn anew by the next; 0: never', 's', 0.0, 1e9
    )
    reset_epochs: int = param(
        -1,
        'epochs in a row that contradict the particles before they are drawn anew; 0: never; -1: as `profile` says',
        '',
        -1,
        1000,
    )
    reset_excess: float = param(
        2.6, 'an epoch does where the median node says less than -(this + ln sigma) in log evidence', '', 0.0, 1e3
    )
    reset_nodes: int = param(3, 'and so many nodes are heard', '', 1, 65535)


@dataclass(frozen=True)
class HumanConfig:
    """One person."""

    profile: str = param(
        'improved',
        'what the parameters that name it are. improved: walk and soft; paper_max, paper_direction: the two filters of '
        'the document; rss_mcl: the baseline with one curve',
        choices=tuple(PROFILES),
    )
    particles: int = param(
        500, 'how many particles (Np), at first and unless `resampling.kld` changes it', '', 2, 1000000
    )
    seed: int = param(0, 'of all draws, which are keyed by seed and epoch', '', 0)
    area: tuple[float, ...] = param(
        (),
        'where a person can be: x_min, y_min, x_max, y_max, or x, y of each corner; empty: the floor plan, else round '
        'the anchors',
        'm',
    )
    target_height: float = param(0.0, 'height at which the node is worn', 'm', -1e4, 1e4)
    floor_plan: str = param(
        '',
        'CSV file of corners x,y [m], an empty line between outline and holes: nobody is outside or walks through '
        'walls; empty: none',
    )
    channel: str = param(
        '', 'file of `calibrate` with the radios of the nodes and, if it has one, their map; empty: the anchors tell'
    )
    lag: float = param(
        0.0, 'a second output tells where he was so long ago, by what was heard since; 0: none', 's', 0.0, 60.0
    )
    signal: SignalConfig = group(SignalConfig)
    motion: MotionConfig = group(MotionConfig)
    resampling: ResamplingConfig = group(ResamplingConfig)
    start: StartConfig = group(StartConfig)

    def checked(self: Checked) -> Checked:
        """Itself, or TrackingError where fields contradict each other."""
        if self.area:
            region_of(tuple(self.area))
        for name in ('los', 'nlos', 'single'):
            if len(getattr(self.signal, name)) != 2:
                raise TrackingError(f'`signal.{name}` takes two numbers: at 1 m [dBm], and per decade [dB]')
        given = {
            'signal.outlier': self.signal.outlier,
            'signal.extra': self.signal.extra,
            'motion.v_max': self.motion.v_max,
        }
        for name, value in given.items():
            if OF_PROFILE < value < 0.0:
                raise TrackingError(f'`{name}` is {value:g}: expected 0 or more, or -1 for what `profile` says')
        if self.motion_kind == 'disc' and self.v_max == 0.0:
            raise TrackingError('`motion.v_max` is 0: a person who cannot move needs no tracker')
        if self.signal.offset_std and self.kernel.kind != 'single':
            raise TrackingError(
                f'`signal.offset_std` {self.signal.offset_std:g} is for one curve: expected `signal.kind` single, '
                f'not {self.kernel.kind}'
            )
        if self.motion.fastest < self.motion.slowest:
            raise TrackingError(
                f'`motion.fastest` {self.motion.fastest:g} is below `motion.slowest` {self.motion.slowest:g}'
            )
        if self.resampling.kld_most < self.resampling.kld_least:
            raise TrackingError(
                f'`resampling.kld_most` {self.resampling.kld_most} is below '
                f'`resampling.kld_least` {self.resampling.kld_least}'
            )
        return self

    def _chosen(self, value: Any, name: str) -> Any:
        return PROFILES[self.profile][name] if value in ('profile', OF_PROFILE) else value

    @property
    def kernel(self) -> Kernel:
        """How residuals are weighed."""
        c = self.signal
        outlier = self._chosen(c.outlier, 'outlier')
        return Kernel(self._chosen(c.kind, 'signal'), c.dof, outlier, c.sharpness, c.least_share)

    @property
    def extra_db(self) -> float:
        """Deviation that is added to a reading's own."""
        return float(self._chosen(self.signal.extra, 'extra'))

    @property
    def motion_kind(self) -> str:
        """walk, random_walk or disc."""
        return str(self._chosen(self.motion.kind, 'motion'))

    @property
    def v_max(self) -> float:
        """Of a disc."""
        return float(self._chosen(self.motion.v_max, 'v_max'))

    @property
    def draws(self) -> int:
        """Places that a start weighs."""
        return int(self._chosen(self.start.draws, 'draws'))

    @property
    def reset_epochs(self) -> int:
        """Epochs in a row that lead to a new start."""
        return int(self._chosen(self.start.reset_epochs, 'reset'))
