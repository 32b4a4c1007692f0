"""The documents' experiments, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.simulation.b_field import b_field
from wsn_tracking.simulation.paths import polygon_loop
from wsn_tracking.simulation.scenario import Scenario
from wsn_tracking.simulation.world import rssi_packets


def a_loop() -> Scenario:
    """Scenario L of seed 000: a rectangle loop at 6 cm/s, nodes on a 1.2 m grid with its border."""
    x, y = np.meshgrid(np.arange(4) * 1.2, np.arange(3) * 1.2)
    anchors = make_anchors(np.arange(1, 13), np.column_stack([x.ravel(), y.ravel()]))
    corners = [(0.6, 0.6), (3.0, 0.6), (3.0, 1.8), (0.6, 1.8)]
    return Scenario(
        name='a_loop',
        configuration='random_q',
        anchors=anchors,
        area=(0.0, 0.0, 3.6, 2.4),
        period=1.0,
        truth=polygon_loop(corners, 0.06, np.arange(120)),
        entry_level='rssi',
        packets=rssi_packets,
        range_noise=0.12,
        alpha=0.3,
    )


SCENARIOS: Mapping[str, Callable[[], Scenario]] = {'a_loop': a_loop, 'b_field': b_field}


def scenario(name: str) -> Scenario:
    """The scenario of that name."""
    if name not in SCENARIOS:
        raise TrackingError(f'there is no scenario `{name}`: expected one of {", ".join(SCENARIOS)}')
    return SCENARIOS[name]()
