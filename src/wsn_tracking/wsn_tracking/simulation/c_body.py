"""The scenarios of seed 003, section 4 and 5: a person among nodes, one of two channels by where his body faces.

Functions take any leading axes. A recorded scenario draws its walk and what is heard by the recording's seed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.models.body import LOS, NLOS, SINGLE, is_behind, mean_rssi
from wsn_tracking.models.draws import keyed
from wsn_tracking.parameters import param
from wsn_tracking.sensing.values import Rssi
from wsn_tracking.simulation.c_mobility import Mobility, Walked, destinations, legs, teleported, turned_body
from wsn_tracking.simulation.paths import Area, circle
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import WORLD

MIND = WORLD + 2  # the stream of draws of a person: his walk and how he holds his body
OUTLIER_DBM = (-100.0, -40.0)  # an outlier reads anything in between


@dataclass(frozen=True)
class BodyConfig:
    """c_walk (E2): legs and pauses on a square of 4 x 4 nodes; the other scenarios differ in their defaults."""

    path: str = param('legs', 'what he does', choices=('legs', 'circle'))
    width: float = param(100.0, 'of the area', 'm', 0.1, 1e5)
    depth: float = param(100.0, 'of the area', 'm', 0.1, 1e5)
    columns: int = param(4, 'of nodes, evenly from border to border', '', 1, 250)
    rows: int = param(4, 'of nodes', '', 1, 250)
    row_gap: float = param(
        0.0, 'between outer rows of nodes, in the middle of the depth; 0: they are at the borders', 'm', 0.0
    )
    reach: float = param(50.0, 'nodes further away are not heard', 'm', 0.1, 1e6)
    sigma: float = param(3.0, 's: standard deviation of a reading', 'dB', 0.01, 100.0)
    period: float = param(0.5, 'dt', 's', 0.01, 100.0)
    duration: float = param(180.0, 'of the walk', 's', 0.0, 1e5)
    slowest: float = param(0.5, 'lowest speed of a leg, or that of a circle', 'm/s', 0.01, 100.0)
    fastest: float = param(2.0, 'highest speed of a leg', 'm/s', 0.01, 100.0)
    longest_pause: float = param(10.0, 'pauses between legs last up to this', 's', 0.0, 1e5)
    turn_after: float = param(0.0, 'mean time until he turns on his way; 0: he does not', 's', 0.0, 1e9)
    margin: float = param(0.0, 'legs end so far inside the area', 'm', 0.0, 1e5)
    hot_spots: tuple[float, ...] = param((), 'places where people go: x, y, x, y, ...', 'm')
    hot_share: float = param(0.0, 'share of the legs that lead to one of them', '', 0.0, 1.0)
    radius: float = param(10.0, 'of a circle', 'm', 0.1, 1e5)
    yaw: float = param(0.0, 'standard deviation of the body against the walking direction', 'rad', 0.0, 10.0)
    yaw_time: float = param(10.0, 'correlation time of that', 's', 0.01, 1e6)
    outliers: float = param(0.0, 'share of readings that are anything from -100 to -40 dBm', '', 0.0, 1.0)
    loss: float = param(0.0, 'share of packets that are lost', '', 0.0, 1.0)
    dead: tuple[int, ...] = param((), 'nodes that die', 'id', 0, 65535)
    dead_from: float = param(90.0, 'when', 's', 0.0, 1e5)
    silent_from: float = param(0.0, 'no node is heard from here ...', 's', 0.0, 1e5)
    silent_until: float = param(0.0, '... to here', 's', 0.0, 1e5)
    teleport_at: float = param(0.0, 'when he is suddenly half the area away; 0: never', 's', 0.0, 1e5)

    @property
    def area(self) -> Area:
        """x_min, y_min, x_max, y_max; a circle is about the origin."""
        if self.path == 'circle':
            return (-0.5 * self.width, -0.5 * self.depth, 0.5 * self.width, 0.5 * self.depth)
        return (0.0, 0.0, self.width, self.depth)

    @property
    def times(self) -> Floats:
        """When epochs are, (K,) [s]."""
        return self.period * np.arange(math.floor(self.duration / self.period + 1e-9) + 1)


@dataclass(frozen=True)
class CircleConfig(BodyConfig):
    """c_circle (E1): four nodes at the corners of 30 x 30 m, a circle at 1 m/s."""

    path: str = param('circle', 'what he does', choices=('legs', 'circle'))
    width: float = param(30.0, 'of the area', 'm', 0.1, 1e5)
    depth: float = param(30.0, 'of the area', 'm', 0.1, 1e5)
    columns: int = param(2, 'of nodes, evenly from border to border', '', 1, 250)
    rows: int = param(2, 'of nodes', '', 1, 250)
    sigma: float = param(1.5, 's: standard deviation of a reading', 'dB', 0.01, 100.0)
    slowest: float = param(1.0, 'lowest speed of a leg, or that of a circle', 'm/s', 0.01, 100.0)


@dataclass(frozen=True)
class SpacingConfig(BodyConfig):
    """c_spacing (E3): as c_walk, with nodes 20 m apart and one epoch a second."""

    columns: int = param(6, 'of nodes, evenly from border to border', '', 1, 250)
    rows: int = param(6, 'of nodes', '', 1, 250)
    period: float = param(1.0, 'dt', 's', 0.01, 100.0)


@dataclass(frozen=True)
class NoiseConfig(BodyConfig):
    """c_noise (E4): as c_walk, with more noise."""

    sigma: float = param(6.0, 's: standard deviation of a reading', 'dB', 0.01, 100.0)


@dataclass(frozen=True)
class CorridorConfig(BodyConfig):
    """c_corridor (E5): 2 x 50 m, nodes every 10 m in two rows 1.5 m apart, slow walking with sudden turns."""

    width: float = param(50.0, 'of the area', 'm', 0.1, 1e5)
    depth: float = param(2.0, 'of the area', 'm', 0.1, 1e5)
    columns: int = param(6, 'of nodes, evenly from border to border', '', 1, 250)
    rows: int = param(2, 'of nodes', '', 1, 250)
    row_gap: float = param(
        1.5, 'between outer rows of nodes, in the middle of the depth; 0: they are at the borders', 'm', 0.0
    )
    slowest: float = param(0.3, 'lowest speed of a leg, or that of a circle', 'm/s', 0.01, 100.0)
    fastest: float = param(0.3, 'highest speed of a leg', 'm/s', 0.01, 100.0)
    longest_pause: float = param(0.0, 'pauses between legs last up to this', 's', 0.0, 1e5)
    turn_after: float = param(30.0, 'mean time until he turns on his way; 0: he does not', 's', 0.0, 1e9)
    margin: float = param(0.5, 'legs end so far inside the area', 'm', 0.0, 1e5)


class Person(NamedTuple):
    """A walk, and where the body faces on it."""

    states: Floats  # (runs, K, 4)
    facing: Floats  # (runs, K) [rad]


def nodes(config: BodyConfig) -> Anchors:
    """The nodes row by row, with the single curve as their path loss."""
    x_min, y_min, x_max, y_max = config.area
    middle, half = 0.5 * (y_min + y_max), 0.5 * (config.row_gap or y_max - y_min)
    x, y = np.meshgrid(
        np.linspace(x_min, x_max, config.columns), np.linspace(middle - half, middle + half, config.rows)
    )
    return make_anchors(
        np.arange(1, x.size + 1),
        np.column_stack([x.ravel(), y.ravel()]),
        p1_dbm=SINGLE.p_ref,
        n=-SINGLE.k / 10.0,
        sigma_db=config.sigma,
    )


def mobility(config: BodyConfig) -> Mobility:
    """How he walks in legs."""
    spots = tuple(zip(config.hot_spots[::2], config.hot_spots[1::2], strict=False))
    if len(config.hot_spots) != 2 * len(spots):
        raise TrackingError(f'`hot_spots` are {list(config.hot_spots)}: expected x, y of each')
    if config.fastest < config.slowest:
        raise TrackingError(f'`fastest` {config.fastest:g} m/s is below `slowest` {config.slowest:g} m/s')
    if 0.0 < config.turn_after < config.period:
        raise TrackingError(
            f'`turn_after` {config.turn_after:g} s is shorter than an epoch, {config.period:g} s: '
            'expected at least that, or 0'
        )
    if 2.0 * config.margin >= min(config.width, config.depth):
        raise TrackingError(f'`margin` {config.margin:g} m leaves nothing of {config.width:g} x {config.depth:g} m')
    x_min, y_min, x_max, y_max = config.area
    inner = (x_min + config.margin, y_min + config.margin, x_max - config.margin, y_max - config.margin)
    return Mobility(
        inner,
        config.slowest,
        config.fastest,
        config.longest_pause,
        config.turn_after or math.inf,
        spots,
        config.hot_share,
    )


def people(config: BodyConfig, runs: int, generator: np.random.Generator) -> Person:
    """Walks (runs, K) and where the bodies face."""
    t = config.times
    if config.path == 'circle':
        way = circle((0.0, 0.0), config.radius, config.slowest, t)
        heading = np.arctan2(way[:, 3], way[:, 2])
        walked = Walked(np.broadcast_to(way, (runs, *way.shape)), np.broadcast_to(heading, (runs, t.size)))
    else:
        mind = mobility(config)
        walked = legs(mind, destinations(mind._replace(hot_share=0.0), runs, generator), t, generator)
        if config.teleport_at:
            walked = teleported(mind, walked, t, config.teleport_at, generator)
    yaw = turned_body(t, config.yaw, config.yaw_time, runs, generator)
    return Person(walked.states, walked.heading + yaw)


def hear(
    config: BodyConfig, anchors: Anchors, position: Floats, facing: Floats, t: float, generator: np.random.Generator
) -> Floats:
    """What the nodes read (..., N) [dBm] of people at positions (..., 2) that face (...) [rad]; NaN: nothing."""
    shape = (*facing.shape, anchors.ids.size)
    normals, kinds, anything, lost = generator.standard_normal(shape), *generator.random((3, *shape))
    towards = anchors.positions[:, :2] - position[..., None, :]
    d = np.hypot(towards[..., 0], towards[..., 1])
    mean = np.where(is_behind(towards, facing), mean_rssi(NLOS, d), mean_rssi(LOS, d))
    low, high = OUTLIER_DBM
    z = np.where(kinds < config.outliers, low + (high - low) * anything, mean + config.sigma * normals)
    dead = np.isin(anchors.ids, config.dead) & (t >= config.dead_from)
    silent = config.silent_from <= t < config.silent_until
    return np.where((d > config.reach) | (lost < config.loss) | dead | silent, np.nan, z)


# ---- as recordings


def body_scenario(name: str, config: BodyConfig, seed: int) -> Scenario:
    """One walk, drawn by the seed of the recording."""
    person = people(config, 1, keyed(seed, MIND, 0))
    return Scenario(
        name=name,
        configuration='human',
        anchors=nodes(config),
        area=config.area,
        period=config.period,
        truth=person.states[0],
        entry_level='rssi',
        packets=partial(_packets, config, person.facing[0]),
    )


def _packets(
    config: BodyConfig, facing: Floats, scenario: Scenario, seed: int, target_id: int, stamps: Sequence[int]
) -> Iterator[Sequence[Rssi]]:
    """What is heard, epoch by epoch."""
    sent = dict.fromkeys(scenario.anchors.ids.tolist(), 0)
    for k, stamp in enumerate(stamps):
        z = hear(config, scenario.anchors, scenario.truth[k, :2], facing[k], k * config.period, keyed(seed, WORLD, k))
        packets = []
        for node, dbm in zip(scenario.anchors.ids.tolist(), z.tolist(), strict=True):
            if math.isnan(dbm):
                continue
            packets.append(Rssi(stamp, node, target_id, sent[node], k, dbm, config.sigma))
            sent[node] += 1
        yield packets


BODY_SCENARIOS = {
    'c_circle': CircleConfig,
    'c_walk': BodyConfig,
    'c_spacing': SpacingConfig,
    'c_noise': NoiseConfig,
    'c_corridor': CorridorConfig,
}
