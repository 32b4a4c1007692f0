"""Scenario of seed 004: a turning target among anchors whose signal strengths get lost on the way.

The document's text breaks off before its simulation: field, walk and radio are the project's. Functions take any
leading axes. The recorded scenario draws its walk by the configuration's seed, and noise and losses by the recording's:
whatever is lost, the noise of what is not stays the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats, Mask, make_anchors
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.links import Loss, gamma
from wsn_tracking.models.measurement import rssi_function
from wsn_tracking.models.motion import coordinated_turn
from wsn_tracking.parameters import param
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import WORLD

PERIOD = 1.0  # T [s]
START = (20.0, 25.0, 0.6)  # x, y [m], heading [rad]
LEG = 15  # epochs between turns that are drawn; the first leg is straight
TURNS = (4.0, 10.0)  # [deg/s]
BACK = 9.0  # [deg/s] of the turn back
INSIDE = (10.0, 90.0)  # [m] beyond which a walk is turned back, in x and y alike
FIELD = (0.0, 100.0)  # [m] in x and y alike; a walk that turns back may leave it for a while


@dataclass(frozen=True)
class LossConfig:
    """The walk, the radio, and what gets lost."""

    loss: float = param(0.3, 'p: share of the packets that is lost in the long run', '', 0.0, 1.0)
    burst: float = param(0.0, 'mean length of a loss; 0: losses know nothing of each other', 'epochs', 0.0, 1e6)
    whole_round: bool = param(False, 'an epoch is lost as a whole, not link by link')
    epochs: int = param(100, 'of one second each', '', 1, 100000)
    seed: int = param(1, 'of the walk', '', 0)
    speed: float = param(3.0, 'of the target', 'm/s', 1e-3, 1e3)
    p1_dbm: float = param(-40.0, 'r0: signal strength at 1 m', 'dBm', -200.0, 50.0)
    n: float = param(3.0, 'path loss exponent', '', 0.1, 10.0)
    sigma_db: float = param(4.0, 'standard deviation of the signal strength', 'dB', 0.01, 100.0)

    def losses(self) -> Loss:
        """The model of what gets lost; TrackingError where its numbers contradict each other."""
        model = Loss(self.loss, self.burst, self.whole_round)
        model.arrival()
        return model


def anchors_of(config: LossConfig) -> Anchors:
    """Sixteen anchors on a grid of 4 x 4, numbered row by row."""
    x, y = np.meshgrid(*[np.linspace(*INSIDE, 4)] * 2)
    places = np.column_stack([x.ravel(), y.ravel()])
    return make_anchors(np.arange(1, 17), places, p1_dbm=config.p1_dbm, n=config.n, sigma_db=config.sigma_db)


def legs(config: LossConfig) -> int:
    """How many turns a walk draws."""
    return -(-config.epochs // LEG)


def walks(config: LossConfig, uniform: Floats) -> Floats:
    """States (..., K, 5) of walks at constant speed, uniform (..., legs, 2): which way each leg turns, and how fast.

    A leg turns at {-1, 0, 1} x U(4, 10) deg/s, the first one not at all; who is outside is turned back to the middle.
    """
    way = np.floor(3.0 * uniform[..., 0]) - 1.0
    rate = np.radians(way * (TURNS[0] + (TURNS[1] - TURNS[0]) * uniform[..., 1]))
    rate[..., 0] = 0.0
    x = np.empty((*uniform.shape[:-2], config.epochs, 5))
    velocity = config.speed * np.array([np.cos(START[2]), np.sin(START[2])])
    now = np.broadcast_to([*START[:2], *velocity, 0.0], x[..., 0, :].shape).copy()
    for k in range(config.epochs):
        now[..., 4] = _turned_back(now, rate[..., k // LEG])
        x[..., k, :] = now
        now = coordinated_turn(now, PERIOD)
    return x


def _turned_back(x: Floats, rate: Floats) -> Floats:
    """The turn rate of a leg, or outside the one that brings the heading round to the middle."""
    outside = np.any((x[..., :2] < INSIDE[0]) | (x[..., :2] > INSIDE[1]), axis=-1)
    to = np.mean(INSIDE) - x[..., :2]
    vx, vy = x[..., 2], x[..., 3]
    off = np.arctan2(vx * to[..., 1] - vy * to[..., 0], vx * to[..., 0] + vy * to[..., 1])
    back = np.clip(off / PERIOD, -np.radians(BACK), np.radians(BACK))
    return np.where(outside, back, rate)


def read(anchors: Anchors, x: Floats, arrived: Mask, normals: Floats) -> Floats:
    """Signal strengths (..., K, N) [dBm] of states (..., K, 5) (seed 004, eq. 1 to 6); NaN where lost."""
    return np.where(arrived, rssi_function(anchors)(x) + anchors.sigma_db * normals, np.nan)


# ---- one of them as a recording


def e_loss(config: LossConfig | None = None) -> Scenario:
    """One walk, and losses as the configuration says; `area` holds both the field and the walk."""
    config = config or LossConfig()
    config.losses()
    truth = walks(config, keyed(config.seed, WORLD, 0).random((legs(config), 2)))
    low = np.floor(np.minimum(FIELD[0], truth[:, :2].min(axis=0))).tolist()
    high = np.ceil(np.maximum(FIELD[1], truth[:, :2].max(axis=0))).tolist()
    return Scenario(
        name='e_loss',
        configuration='loss_tolerant',
        anchors=anchors_of(config),
        area=(low[0], low[1], high[0], high[1]),
        period=PERIOD,
        truth=truth[:, :4],
        entry_level='rssi',
        packets=partial(_packets, config.losses()),
    )


def _packets(
    losses: Loss, scenario: Scenario, seed: int, target_id: int, stamps: Sequence[int]
) -> Iterator[Sequence[Rssi]]:
    """What arrives of one packet of every anchor, epoch by epoch."""
    ids = scenario.anchors.ids
    draws = [keyed(seed, WORLD, k) for k in range(len(stamps))]
    normals = np.stack([generator.standard_normal(ids.size) for generator in draws])
    arrived = gamma(losses, np.stack([generator.random(ids.size) for generator in draws]))
    z = read(scenario.anchors, scenario.truth, arrived, normals)
    for k, stamp in enumerate(stamps):
        rssi = zip(ids.tolist(), z[k].tolist(), arrived[k].tolist(), strict=True)
        yield [Rssi(stamp, node, target_id, k, k, dbm) for node, dbm, heard in rssi if heard]
