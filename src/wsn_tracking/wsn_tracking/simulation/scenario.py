"""What an experiment is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.sensing.values import Measurement


class Scenario(NamedTuple):
    """One experiment: the field, the walk, and what the nodes say of it."""

    name: str
    configuration: str  # the configuration file that tracks it
    anchors: Anchors
    area: tuple[float, float, float, float]  # x_min, y_min, x_max, y_max [m]
    period: float  # T [s]
    truth: Floats  # (K, 4) states at k T
    entry_level: str  # rssi, range or observation
    packets: Packets
    range_noise: float = float('nan')  # rssi: standard deviation as a share of the range
    alpha: float = float('nan')  # rssi: pre-filter of the event trigger
    companions: tuple[Floats, ...] = ()  # (K, 4) each: states of further targets, with the ids that follow


# (scenario, seed, target id, stamps of the epochs [ns]) -> what the nodes send, epoch by epoch
Packets = Callable[[Scenario, int, int, Sequence[int]], Iterator[Sequence[Measurement]]]
