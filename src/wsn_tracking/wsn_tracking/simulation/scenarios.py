"""The documents' experiments, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.simulation.paths import polygon_loop


class Scenario(NamedTuple):
    """One experiment: the field, the walk and the radio's real noise."""

    name: str
    configuration: str  # the configuration file that tracks it
    anchors: Anchors
    area: tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]
    period: float  # T [s]
    truth: Floats  # (K, 4) states at k T
    range_noise: float  # standard deviation as a share of the range
    alpha: float  # pre-filter of the event trigger


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
        range_noise=0.12,
        alpha=0.3,
    )


SCENARIOS: Mapping[str, Callable[[], Scenario]] = {'a_loop': a_loop}


def scenario(name: str) -> Scenario:
    """The scenario of that name."""
    if name not in SCENARIOS:
        raise TrackingError(f'there is no scenario `{name}`: expected one of {", ".join(SCENARIOS)}')
    return SCENARIOS[name]()
