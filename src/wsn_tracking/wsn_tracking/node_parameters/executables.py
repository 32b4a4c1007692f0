"""Which parameters an executable has."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wsn_tracking.node_parameters.consensus import ConsensusNodeConfig
from wsn_tracking.node_parameters.estimator import EstimatorNodeConfig
from wsn_tracking.node_parameters.feeds import PlayerConfig, WorldConfig
from wsn_tracking.node_parameters.human import HumanNodeConfig
from wsn_tracking.node_parameters.hybrid import HybridNodeConfig
from wsn_tracking.node_parameters.listeners import EvaluatorConfig, MarkerConfig, RecorderConfig
from wsn_tracking.node_parameters.loss_tolerant import LossTolerantNodeConfig
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.node_parameters.serial import SerialBridgeConfig, SinkSimulatorConfig

EXECUTABLES: Mapping[str, type[Any]] = {
    'sensing_node': SensingNodeConfig,
    'serial_bridge_node': SerialBridgeConfig,
    'sink_simulator': SinkSimulatorConfig,
    'estimator_node': EstimatorNodeConfig,
    'consensus_node': ConsensusNodeConfig,
    'human_tracker_node': HumanNodeConfig,
    'hybrid_tracker_node': HybridNodeConfig,
    'loss_tolerant_tracker_node': LossTolerantNodeConfig,
    'world_node': WorldConfig,
    'bag_player_node': PlayerConfig,
    'bag_recorder_node': RecorderConfig,
    'evaluator_node': EvaluatorConfig,
    'marker_node': MarkerConfig,
}
