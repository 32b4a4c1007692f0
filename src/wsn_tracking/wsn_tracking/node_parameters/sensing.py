"""Parameters of sensing_node."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.parameters import group, param
from wsn_tracking.sensing.stage import TriggerConfig


@dataclass(frozen=True)
class SensingNodeConfig(AssemblyConfig):
    """sensing_node."""

    ids: tuple[int, ...] = param((), 'the sensing nodes that live in this process; empty: all anchors', 'id', 0, 65535)
    seed: int = param(0, 'of the random trigger; the draw is keyed by seed, node and epoch', '', 0)
    channel: str = param('', 'file of `calibrate` that ranges are inverted with; empty: the anchors tell')
    trigger: TriggerConfig = group(TriggerConfig)
