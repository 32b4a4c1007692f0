"""Scenario of seed 002, section 3: a random field whose nodes see range and bearing of a passing target, with gaps.

Functions take any leading axes. The recorded scenario draws its field and walk by the configuration's seed, and what
the nodes read by the recording's, epoch by epoch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats, Mask, make_anchors
from wsn_tracking.models.arrival import Arrival, chain
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.graph import adjacency, is_connected
from wsn_tracking.models.motion import constant_velocity
from wsn_tracking.models.noise import white_acceleration
from wsn_tracking.models.range_bearing import range_bearing_function, wrapped
from wsn_tracking.parameters import param
from wsn_tracking.sensing.values import RangeBearing
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import WORLD

TRIES = 1000  # fields that are drawn before a radius is called too small


@dataclass(frozen=True)
class FieldConfig:
    """The field, the walk through it, and what goes wrong."""

    nodes: int = param(50, 'N: sensing nodes', '', 1, 65535)
    width: float = param(350.0, 'of the field', 'm', 1.0, 1e6)
    depth: float = param(400.0, 'of the field', 'm', 1.0, 1e6)
    radius: float = param(100.0, 'a field is drawn anew until this radio radius connects it; 0: any', 'm', 0.0, 1e6)
    epochs: int = param(50, 'of one second each', '', 1, 100000)
    seed: int = param(1, 'of the field and the walk', '', 0)
    mean: tuple[float, ...] = param((50.0, 50.0, 10.0, 10.0), 'of the start: x, y, vx, vy', 'm and m/s')
    std: tuple[float, ...] = param((10.0, 10.0, 3.0, 3.0), 'of the start', 'm and m/s', 0.0)
    spectral_density: float = param(1.0, 'q_w: of the white acceleration', 'm^2/s^3', 0.0, 1e6)
    range_std: float = param(0.1, 'of a range', 'm', 1e-6, 1e4)
    bearing_std: float = param(0.5, 'of a bearing', 'rad', 1e-6, 10.0)
    fault_rate: float = param(0.05, 'p: an arriving node loses its next observation', '', 0.0, 1.0)
    repair_rate: float = param(0.4, 'q: a losing node has its next observation arrive', '', 0.0, 1.0)
    first_rate: float = param(0.8, 'probability that the first observation arrives', '', 0.0, 1.0)
    faults: str = param(
        'zero',
        'what a lost observation reads. zero: noise alone (the document); clutter: anything; absent: nothing',
        choices=('zero', 'clutter', 'absent'),
    )
    r_max: float = param(600.0, 'clutter: longest range', 'm', 1e-3, 1e6)
    dead: tuple[int, ...] = param((), 'nodes that die', 'id', 0, 65535)
    dead_from: int = param(25, 'first epoch without them', '', 0)

    def checked(self) -> FieldConfig:
        """Itself, or TrackingError where the start is none."""
        if len(self.mean) != 4 or len(self.std) != 4:
            raise TrackingError('`mean` and `std` take four numbers each: x, y, vx, vy')
        return self


def grown(config: FieldConfig, nodes: int) -> FieldConfig:
    """The field with so many nodes, and as dense."""
    side = math.sqrt(nodes / config.nodes)
    return replace(config, nodes=nodes, width=config.width * side, depth=config.depth * side)


class Readings(NamedTuple):
    """What the nodes read."""

    z: Floats  # (..., N, 2) range [m], bearing [rad]; NaN: nothing
    arrived: Mask  # (..., N) whether it is of the target


class Draws(NamedTuple):
    """The random numbers of readings."""

    normals: Floats  # (..., N, 2)
    uniforms: Floats  # (..., N, 2)


def fields(config: FieldConfig, runs: int, generator: np.random.Generator) -> Floats:
    """Positions (runs, N, 3) [m] of connected fields."""
    size = np.array([config.width, config.depth])
    kept = np.empty((0, config.nodes, 2))
    for _ in range(TRIES):
        drawn = size * generator.random((runs, config.nodes, 2))
        if config.radius > 0.0:
            drawn = drawn[is_connected(adjacency(drawn, config.radius))]
        kept = np.concatenate([kept, drawn])
        if len(kept) >= runs:
            return np.concatenate([kept[:runs], np.zeros((runs, config.nodes, 1))], axis=-1)
    raise TrackingError(
        f'{config.nodes} nodes on {config.width:g} x {config.depth:g} m are hardly ever connected at a radius of '
        f'{config.radius:g} m: expected a larger `radius`, or 0 for a field that may fall apart'
    )


def walks(config: FieldConfig, runs: int, generator: np.random.Generator) -> Floats:
    """States (runs, K, 4) of white acceleration from x0 ~ N(mean, diag(std^2)) on (seed 002, eq. 1 to 3)."""
    F, chol_Q = constant_velocity(1.0), white_acceleration(config.spectral_density, 1.0)
    x = np.empty((runs, config.epochs, 4))
    x[:, 0] = np.array(config.mean) + np.array(config.std) * generator.standard_normal((runs, 4))
    for k in range(1, config.epochs):
        x[:, k] = x[:, k - 1] @ F.T + generator.standard_normal((runs, 4)) @ chol_Q.T
    return x


def arrivals(config: FieldConfig, uniform: Floats) -> Mask:
    """Whether each observation arrives, (..., K, N) of uniform draws."""
    return chain(Arrival(config.fault_rate, config.repair_rate, config.first_rate), uniform)


def draw(generator: np.random.Generator, shape: tuple[int, ...]) -> Draws:
    """Draws for nodes (..., N)."""
    return Draws(generator.standard_normal((*shape, 2)), generator.random((*shape, 2)))


def read(config: FieldConfig, positions: Floats, states: Floats, arrived: Mask, draws: Draws) -> Readings:
    """Readings (..., N) of targets at states (..., 4) by nodes at positions (..., N, 3) (seed 002, eq. 4)."""
    target = np.broadcast_to(states[..., None, :], (*arrived.shape, states.shape[-1]))
    noise = np.array([config.range_std, config.bearing_std]) * draws.normals
    true = range_bearing_function(positions, target)(target[..., None, :])[..., 0, :] + noise
    if config.faults == 'zero':
        false = noise
    elif config.faults == 'clutter':
        false = np.stack([config.r_max * draws.uniforms[..., 0], np.pi * (1.0 - 2.0 * draws.uniforms[..., 1])], axis=-1)
    else:
        false = np.full_like(noise, np.nan)
    z = np.where(arrived[..., None], true, false)
    z[..., 1] = wrapped(z[..., 1])
    return Readings(z, arrived)


# ---- one of them as a recording


def b_field(config: FieldConfig | None = None) -> Scenario:
    """One field and one walk; `area` holds both, since the target leaves the field."""
    config = (config or FieldConfig()).checked()
    generator = keyed(config.seed, WORLD, 0)
    positions = fields(config, 1, generator)[0]
    truth = walks(config, 1, generator)[0]
    low = np.floor(np.minimum([0.0, 0.0], truth[:, :2].min(axis=0)))
    high = np.ceil(np.maximum([config.width, config.depth], truth[:, :2].max(axis=0)))
    return Scenario(
        name='b_field',
        configuration='consensus',
        anchors=make_anchors(np.arange(1, config.nodes + 1), positions),
        area=(float(low[0]), float(low[1]), float(high[0]), float(high[1])),
        period=1.0,
        truth=truth,
        entry_level='observation',
        packets=partial(_packets, config),
    )


def _packets(
    config: FieldConfig, scenario: Scenario, seed: int, target_id: int, stamps: Sequence[int]
) -> Iterator[Sequence[RangeBearing]]:
    """What every living node sends, epoch by epoch; one that knows that nothing arrived says so."""
    ids = scenario.anchors.ids
    generators = [keyed(seed, WORLD, k) for k in range(len(stamps))]
    arrived = arrivals(config, np.stack([generator.random(ids.size) for generator in generators]))
    covariance = (config.range_std**2, 0.0, 0.0, config.bearing_std**2)
    for k, stamp in enumerate(stamps):
        draws = draw(generators[k], ids.shape)
        z, _ = read(config, scenario.anchors.positions, scenario.truth[k], arrived[k], draws)
        heard = arrived[k] if config.faults == 'absent' else np.ones(ids.size, dtype=np.bool_)
        yield [
            RangeBearing(stamp, node, target_id, k, k, distance, bearing, covariance, tells)
            for node, (distance, bearing), tells in zip(ids.tolist(), z.tolist(), heard.tolist(), strict=True)
            if not (node in config.dead and k >= config.dead_from)
        ]
