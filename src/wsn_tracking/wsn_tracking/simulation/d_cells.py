"""Scenarios of seed 001, section 3: twelve ultrasonic nodes in six cells, of which the one round the target measures.

The base station chooses the cell from its prediction, never from truth; one node of it ranges the target in each
period, its corners in turn. Until the station has a position all nodes take turns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.models.draws import keyed
from wsn_tracking.models.measurement import distances
from wsn_tracking.models.radio import MIN_RANGE
from wsn_tracking.parameters import param
from wsn_tracking.sensing.scheduler import CellScheduler
from wsn_tracking.sensing.values import Modality, Range
from wsn_tracking.simulation import paths
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.station import SightLine, Station
from wsn_tracking.simulation.world import WORLD

AREA = (0.0, 0.0, 4.0, 6.0)  # [m]
CELLS = WORLD + 2  # the stream of draws of the first target's ranges, those of others follow
SPEED = 0.5  # [m/s] before the stop
Stations = Callable[[], Station]


@dataclass(frozen=True)
class CellsConfig:
    """The radio of the field, and how long the target rests."""

    period: float = param(0.05, 'T: between ranges of a target', 's', 1e-3, 60.0)
    range_std: float = param(0.02, 'of a range', 'm', 0.0, 1e3)
    dropout: float = param(0.0, 'share of the ranges that are lost', '', 0.0, 1.0)
    rest: float = param(5.0, 'what is recorded after the stop', 's', 0.0, 1e4)
    lasts: float = param(30.0, 'd_phase: what is recorded', 's', 1.0, 1e4)
    variation: float = param(0.1, 'd_phase: by which the angular speed varies, slowly', '', 0.0, 0.9)


@dataclass(frozen=True)
class DropoutConfig(CellsConfig):
    """The same with ranges that are lost."""

    dropout: float = param(0.3, 'share of the ranges that are lost', '', 0.0, 1.0)


class Measured(NamedTuple):
    """One range, or one a period (..., K)."""

    rows: np.ndarray[tuple[int, ...], np.dtype[np.int64]]  # (...) row of the node that was asked
    z: Floats  # (...) [m]; NaN: lost


def nodes() -> Anchors:
    """Twelve nodes at x 0, 2, 4 and y 0, 2, 4, 6 m, numbered row by row."""
    x, y = np.meshgrid([0.0, 2.0, 4.0], [0.0, 2.0, 4.0, 6.0])
    return make_anchors(np.arange(1, 13), np.column_stack([x.ravel(), y.ravel()]))


class Ranging:
    """The base station and its nodes, a range a period for each of the targets (...); draws are given."""

    def __init__(self, config: CellsConfig, shape: tuple[int, ...] = (), station: Station | None = None) -> None:
        self._config = config
        self._anchors = nodes()
        self._scheduler = CellScheduler(self._anchors)
        self._station = station or SightLine(self._anchors.ids.size, shape)
        self._cell: np.ndarray[tuple[int, ...], np.dtype[np.int64]] | None = None

    def step(self, k: int, states: Floats, normals: Floats, uniforms: Floats) -> Measured:
        """The range of period k to targets at states (..., 2 or more); normals, uniforms and what comes back (...)."""
        config, anchors, t = self._config, self._anchors, k * self._config.period
        prediction = self._station.predict(t)
        known = ~np.isnan(prediction[..., 0])
        self._cell = self._scheduler.cell(np.nan_to_num(prediction), self._cell)
        asked = np.where(known, anchors.rows(self._scheduler.node(self._cell, k)), k % anchors.ids.size)
        true = np.take_along_axis(distances(anchors, states), asked[..., None], axis=-1)[..., 0]
        heard = np.maximum(true + config.range_std * normals, MIN_RANGE)
        z = np.where(uniforms < config.dropout, np.nan, heard)
        self._station.hear(t, anchors.positions[asked, :2], z)
        return Measured(asked, z)


def draws(seed: int, target_id: int, k: int) -> tuple[Floats, Floats]:
    """Of noise, N(0, 1), and of loss, U(0, 1), of the range to a target in period k; equal seeds give equal ones."""
    generator = keyed(seed, CELLS + target_id, k)
    return np.asarray(generator.standard_normal()), np.asarray(generator.random())


def measure(
    config: CellsConfig, states: Floats, normals: Floats, uniforms: Floats, station: Station | None = None
) -> Measured:
    """Ranges (..., K) to targets at states (..., K, 4), each of the node that the station's prediction chooses.

    normals and uniforms (..., K) are the draws of noise and loss.
    """
    ranging = Ranging(config, states.shape[:-2], station)
    told = [ranging.step(k, states[..., k, :], normals[..., k], uniforms[..., k]) for k in range(states.shape[-2])]
    return Measured(np.stack([m.rows for m in told], axis=-1), np.stack([m.z for m in told], axis=-1))


def d_stop(config: CellsConfig | None = None, stations: Stations | None = None) -> Scenario:
    """Straight at 0.5 m/s through two cells, then a sudden stop where the third begins."""
    config = config or CellsConfig()
    way = 3.5
    times = _times(config, way / SPEED + config.rest)
    return _scenario('d_stop', config, paths.line_and_stop((1.0, 0.5), (0.0, SPEED), way / SPEED, times), (), stations)


def d_arc_stop(config: CellsConfig | None = None, stations: Stations | None = None) -> Scenario:
    """A circle of 1 m round the middle of the four lowest cells at 0.5 rad/s, then a sudden stop between two cells."""
    config = config or CellsConfig()
    turned = 1.25 * np.pi
    times = _times(config, turned / 0.5 + config.rest)
    angle = -0.25 * np.pi + np.minimum(0.5 * times, turned)
    return _scenario(
        'd_arc_stop', config, paths.round_circle((2.0, 2.0), 1.0, angle, np.where(0.5 * times < turned, 0.5, 0.0)), (),
        stations,
    )  # fmt: skip


def d_phase(config: CellsConfig | None = None, stations: Stations | None = None) -> Scenario:
    """Two robots in phase: 0.5 m at 0.3 m/s in the upper left cell, 1 m at 0.6 m/s in the four lowest cells."""
    config = config or CellsConfig()
    times = _times(config, config.lasts)
    w, slow = 0.6, 2.0 * np.pi / 15.0
    angle = w * (times + config.variation / slow * (1.0 - np.cos(slow * times)))
    turning = w * (1.0 + config.variation * np.sin(slow * times))
    first = paths.round_circle((1.0, 5.0), 0.5, angle, turning)
    second = paths.round_circle((2.0, 2.0), 1.0, angle, turning)
    return _scenario('d_phase', config, first, (second,), stations)


def d_dropout(config: DropoutConfig | None = None, stations: Stations | None = None) -> Scenario:
    """A round through all six cells at 0.5 m/s that ends with a sudden stop between two, a third of the ranges lost."""
    config = config or DropoutConfig()
    corners = [(1.0, 1.0), (3.0, 1.0), (3.0, 5.0), (1.0, 5.0)]
    way = 11.0  # back down to y = 2
    times = _times(config, way / SPEED + config.rest)
    walk = paths.polygon_loop(corners, SPEED, np.minimum(times, way / SPEED))
    walk[times >= way / SPEED, 2:] = 0.0
    return _scenario('d_dropout', config, walk, (), stations)


def _times(config: CellsConfig, lasts: float) -> Floats:
    return np.asarray(np.arange(round(lasts / config.period) + 1) * config.period)


def _scenario(
    name: str, config: CellsConfig, truth: Floats, companions: tuple[Floats, ...], stations: Stations | None
) -> Scenario:
    return Scenario(
        name=name,
        configuration='hybrid',
        anchors=nodes(),
        area=AREA,
        period=config.period,
        truth=truth,
        entry_level='range',
        packets=partial(_packets, config, stations),
        companions=companions,
    )


def _packets(
    config: CellsConfig, stations: Stations | None, scenario: Scenario, seed: int, target_id: int, stamps: Sequence[int]
) -> Iterator[Sequence[Range]]:
    """One range a period, or none where it was lost."""
    normals, uniforms = np.array([draws(seed, target_id, k) for k in range(len(stamps))]).T
    told = measure(config, scenario.truth, normals, uniforms, stations() if stations else None)
    asked = scenario.anchors.ids[told.rows]
    variance = config.range_std**2 if config.range_std else float('nan')
    for k, (stamp, node, z) in enumerate(zip(stamps, asked.tolist(), told.z.tolist(), strict=True)):
        packet = Range(stamp, node, target_id, k, k, int(Modality.ULTRASOUND), z, variance)
        yield [] if np.isnan(z) else [packet]
