"""The experiments of seed 000: a robot on 3.6 x 2.4 m, whose nodes hear it within some metres."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.models.draws import keyed
from wsn_tracking.simulation.paths import circle, headings_inside, polygon_loop
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import WORLD, rssi_packets

AREA = (0.0, 0.0, 3.6, 2.4)  # [m] of seed 000
SPEED = 0.06  # [m/s] of its robot
WALK = WORLD + 1  # the stream of draws of a walk


def a_loop() -> Scenario:
    """Scenario L of seed 000: a rectangle loop at 6 cm/s, nodes on a 1.2 m grid with its border."""
    corners = [(0.6, 0.6), (3.0, 0.6), (3.0, 1.8), (0.6, 1.8)]
    return _robot('a_loop', 'random_q', _on_grid(), polygon_loop(corners, SPEED, np.arange(120)), 0.12, 0.3)


def a_circle() -> Scenario:
    """Scenario C: always turning, nodes at the middles of 0.9 x 0.8 m cells, less noise than the filter assumes.

    The document's table of process noises has its shape on such a target alone.
    """
    anchors = _nodes([0.45, 1.35, 2.25, 3.15], [0.4, 1.2, 2.0])
    walk = circle((1.8, 1.2), 0.13, SPEED, np.arange(100))
    return _robot('a_circle', 'a_circle', anchors, walk, 0.62 * 0.12, 0.45)


def a_heading(seed: int = 0) -> Scenario:
    """Scenario H: a new random heading every 10 s, reflected 0.2 m inside the border; the field is scenario L's.

    The walk is drawn by the seed of the recording.
    """
    headings = 2.0 * np.pi * keyed(seed, WALK, 0).random(12)
    inside = (AREA[0] + 0.2, AREA[1] + 0.2, AREA[2] - 0.2, AREA[3] - 0.2)
    walk = headings_inside(inside, headings, SPEED, 10.0, np.arange(120))
    return _robot('a_heading', 'a_heading', _on_grid(), walk, 0.12, 0.27)


def _robot(
    name: str, configuration: str, anchors: Anchors, truth: Floats, range_noise: float, alpha: float
) -> Scenario:
    return Scenario(
        name=name,
        configuration=configuration,
        anchors=anchors,
        area=AREA,
        period=1.0,
        truth=truth,
        entry_level='rssi',
        packets=rssi_packets,
        range_noise=range_noise,
        alpha=alpha,
    )


def _on_grid() -> Anchors:
    return _nodes(np.arange(4) * 1.2, np.arange(3) * 1.2)


def _nodes(columns: ArrayLike, rows: ArrayLike) -> Anchors:
    """Twelve nodes, numbered row by row."""
    x, y = np.meshgrid(columns, rows)
    return make_anchors(np.arange(1, x.size + 1), np.column_stack([x.ravel(), y.ravel()]))
