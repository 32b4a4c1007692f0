"""Parameters of system B: one filter of the consensus network."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters import information
from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.arrival import Arrival
from wsn_tracking.models.links import Links
from wsn_tracking.models.motion import forgetful_velocity
from wsn_tracking.parameters import group, param


@dataclass(frozen=True)
class ArrivalConfig:
    """The two-state Markov chain of each node's observations, and what the loss state reads."""

    fault_rate: float = param(0.05, 'p: an arriving node loses its next observation', '', 1e-6, 1.0 - 1e-6)
    repair_rate: float = param(0.4, 'q: a losing node has its next observation arrive', '', 1e-6, 1.0 - 1e-6)
    start: float = param(0.8, 'probability that the first observation arrives', '', 1e-6, 1.0 - 1e-6)
    loss: str = param(
        'uniform',
        'what is read when nothing arrives. uniform: anything; zero: noise alone (the document); absent: nothing, so '
        'that whatever is read counts in full',
        choices=('uniform', 'zero', 'absent'),
    )
    r_max: float = param(600.0, 'uniform: the longest range that may be read', 'm', 1e-3, 1e6)


@dataclass(frozen=True)
class ObservationConfig:
    """Noise of observations that do not tell their own, and how they are linearised."""

    range_std: float = param(0.1, 'of a range', 'm', 1e-6, 1e4)
    bearing_std: float = param(0.5, 'of a bearing', 'rad', 1e-6, 10.0)
    linearisation_epochs: float = param(
        8.0,
        'w: for how many epochs an error of linearisation stays the same, and counts as one, where a node is alone; '
        'among n live nodes w / n, at least one. 1: each is new, which is the cubature Kalman filter',
        '',
        1.0,
        1000.0,
    )
    printed_form: bool = param(False, 'leave the linearisation error out of R, as the document prints it')

    def omega_weight(self, live: Floats) -> Floats:
        """Of the linearisation error in what an observation is worth, among so many live nodes, (...)."""
        return np.asarray(0.0 if self.printed_form else np.maximum(1.0, self.linearisation_epochs / live))


@dataclass(frozen=True)
class PriorConfig:
    """First belief of every node."""

    mean: tuple[float, ...] = param((50.0, 50.0, 10.0, 10.0), 'x, y, vx, vy', 'm and m/s')
    std: tuple[float, ...] = param((10.0, 10.0, 3.0, 3.0), 'their standard deviations', 'm and m/s', 1e-6)


@dataclass(frozen=True)
class LinkConfig:
    """Simulated faults of the links between nodes; a real network has its own."""

    loss: float = param(0.0, 'probability that a receiver misses a share', '', 0.0, 1.0)
    seed: int = param(0, 'of the losses; a draw is keyed by seed, epoch, round, sender and receiver', '', 0)
    cut_at: float = param(0.0, 'links across this x are cut for some epochs', 'm')
    cut_from: int = param(0, 'first epoch in which they are', '', 0)
    cut_until: int = param(0, 'first epoch in which they are no longer', '', 0)

    def links(self) -> Links:
        """The same for the model."""
        return Links(self.loss, self.seed, self.cut_at, self.cut_from, self.cut_until)


@dataclass(frozen=True)
class ConsensusConfig:
    """One node of the network, the same for all of them."""

    scheme: str = param(
        'icf',
        'icf: prior and contributions are averaged; cm: contributions alone (the document); chebyshev: icf '
        'accelerated; flood: contributions are forwarded by name; hcmci: never overconfident',
        choices=('icf', 'cm', 'chebyshev', 'flood', 'hcmci'),
    )
    rounds: int = param(20, 'L: exchanges with the neighbours in an epoch; 0: every node on its own', '', 0, 1000)
    radius: float = param(100.0, 'nodes nearer than this are neighbours', 'm', 1e-3, 1e6)
    silent_epochs: int = param(3, 'a neighbour not heard for so many epochs is no longer counted', '', 1, 1000)
    spectral_density: float = param(1.0, 'q_w: of the white acceleration', 'm^2/s^3', 1e-12, 1e6)
    velocity_time: float = param(
        0.0, 'a velocity is forgotten with this time constant; 0: never (the document)', 's', 0.0, 1e6
    )
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)
    arrival: ArrivalConfig = group(ArrivalConfig)
    observation: ObservationConfig = group(ObservationConfig)
    prior: PriorConfig = group(PriorConfig)
    link: LinkConfig = group(LinkConfig)

    def checked(self) -> ConsensusConfig:
        """Itself, or TrackingError where fields contradict each other."""
        if len(self.prior.mean) != 4 or len(self.prior.std) != 4:
            raise TrackingError('`prior.mean` and `prior.std` take four numbers each: x, y, vx, vy')
        if self.link.cut_until < self.link.cut_from:
            raise TrackingError(
                f'`link.cut_until` {self.link.cut_until} is before `link.cut_from` {self.link.cut_from}'
            )
        return self


def arrival_of(config: ConsensusConfig) -> Arrival:
    """The chain of the model."""
    return Arrival(config.arrival.fault_rate, config.arrival.repair_rate, config.arrival.start)


def loss_model_of(config: ConsensusConfig) -> information.LossModel:
    """The density of what is read in the loss state."""
    if config.arrival.loss == 'uniform':
        return information.uniform(config.arrival.r_max)
    return {'zero': information.zero, 'absent': information.absent}[config.arrival.loss]


def motion_of(config: ConsensusConfig, dt: float) -> tuple[Floats, Floats]:
    """Transition matrix and root of the process noise over dt [s], (4, 4) each."""
    return forgetful_velocity(config.spectral_density, dt, config.velocity_time)


def prior_of(config: ConsensusConfig) -> Belief:
    """The first belief, (4,)."""
    return Belief(np.array(config.prior.mean), np.diag(np.array(config.prior.std)))


def noise_of(config: ConsensusConfig) -> Floats:
    """R (2, 2) of range [m] and bearing [rad]."""
    return np.diag(np.square([config.observation.range_std, config.observation.bearing_std]))
