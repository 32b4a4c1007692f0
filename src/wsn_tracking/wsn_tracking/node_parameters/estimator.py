"""Parameters of estimator_node."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.parameters import param
from wsn_tracking.trackers.estimator import EstimatorConfig


@dataclass(frozen=True)
class EstimatorNodeConfig(EstimatorConfig, AssemblyConfig):
    """estimator_node."""

    fusion_timeout: float = param(
        0.2, 'how long the fusion of an epoch waits for live peers (0.2 T)', 's', 1e-3, 3600.0
    )
