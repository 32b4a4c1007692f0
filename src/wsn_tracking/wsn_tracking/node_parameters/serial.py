"""Parameters of serial_bridge_node and sink_simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wsn_tracking.driven_air import DrivenConfig
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats, make_anchors
from wsn_tracking.parameters import group, param
from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.settings import LinkConfig
from wsn_tracking.zstack.simulator_settings import SimulatorConfig


@dataclass(frozen=True)
class AnchorsConfig:
    """The table of nodes that a bridge publishes; columns of one entry are for every node."""

    ids: tuple[int, ...] = param((), 'node ids; empty: somebody else publishes `anchors`', 'id', 0, 65535)
    x: tuple[float, ...] = param((), 'positions', 'm')
    y: tuple[float, ...] = param((), 'positions', 'm')
    z: tuple[float, ...] = param((0.0,), 'heights', 'm')
    p1_dbm: tuple[float, ...] = param((-45.0,), 'signal strength at 1 m', 'dBm')
    n: tuple[float, ...] = param((3.0,), 'path loss exponent', '', 0.1, 10.0)
    sigma_db: tuple[float, ...] = param((1.56,), 'standard deviation of the signal strength', 'dB', 0.01, 100.0)

    @property
    def table(self) -> Anchors:
        """The table; TrackingError where columns do not fit."""
        n = len(self.ids)
        columns: dict[str, Floats] = {}
        for name in ('x', 'y', 'z', 'p1_dbm', 'n', 'sigma_db'):
            column = getattr(self, name)
            if len(column) not in {n, 1}:
                raise TrackingError(
                    f'parameter `anchors.{name}` has {len(column)} entries, `anchors.ids` {n}: expected as many, or 1'
                )
            columns[name] = np.broadcast_to(column, n)
        positions = np.column_stack([columns.pop(axis) for axis in 'xyz'])
        return make_anchors(self.ids, positions, **columns)


@dataclass(frozen=True)
class SerialBridgeConfig(LinkConfig, ClockConfig):
    """serial_bridge_node."""

    period: float = param(1.0, 'T, time between requests of a target', 's', 1e-3, 3600.0)
    epoch_timeout: float = param(0.0, 'after the first word of an epoch until its EpochEnd; 0: 0.4 T', 's', 0.0, 3600.0)
    node_map: tuple[str, ...] = param(('',), 'radio=node, where a radio bears another id than its node; empty: none')
    range_modality: int = param(3, 'what measures ranges: 2 UWB, 3 ultrasound, 4 other', '', 1, 4)
    feedback: bool = param(False, 'send the estimates on `feedback_topics` to the robots')
    feedback_topics: tuple[str, ...] = param(('feedback',), 'topics of these, e.g. estimate/hybrid_target_1')
    feedback_period: float = param(0.0, 'least time between two of a target; 0: all are sent', 's', 0.0, 3600.0)
    feedback_address: int = param(0xFFFF, 'network address that feedback is sent to; 65535: all', '', 0, 0xFFFF)
    sensing_command: bool = param(False, 'send the commands on `sensing_command` to the sensing nodes')
    topology_period: float = param(30.0, 'how often the sink is asked for its neighbours; 0: never', 's', 0.0, 86400.0)
    anchors: AnchorsConfig = group(AnchorsConfig)

    @property
    def ends_after(self) -> float:
        """How long after its first word an epoch ends [s]."""
        return self.epoch_timeout or 0.4 * self.period


@dataclass(frozen=True)
class SinkSimulatorConfig(SimulatorConfig):
    """sink_simulator."""

    scenario: str = param('a_loop', 'experiment behind the sink')
    bag: str = param('', 'bag behind the sink, in the place of a scenario')
    target_id: int = param(-1, 'the one target that is there; -1: all', 'id', -1, 65535)
    expected_nodes: tuple[str, ...] = param(
        ('',), 'names of the nodes that must be ready before the nodes speak; empty: none'
    )
    publish_anchors: bool = param(True, 'publish the table of nodes, for a bridge that has none')
    driven: DrivenConfig = group(DrivenConfig)
    linger: float = param(5.0, 'how long it stays after the last message; 0: until it is ended', 's', 0.0, 1e9)
