"""Parameters of loss_tolerant_tracker_node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.sensing.channel_file import check_channel
from wsn_tracking.trackers.loss_tolerant import OUTPUT, LossTolerantTracker
from wsn_tracking.trackers.loss_tolerant_config import LossTolerantConfig


@dataclass(frozen=True)
class LossTolerantNodeConfig(LossTolerantConfig, TrackerNodeConfig):
    """loss_tolerant_tracker_node."""

    system: ClassVar[str] = 'loss_tolerant'

    def checked(self) -> LossTolerantNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        LossTolerantConfig.checked(self)
        return self

    def check_files(self) -> None:
        """Raise TrackingError where a file that is named cannot be read."""
        check_channel(self.channel)

    def tracker(self, anchors: Anchors, target_id: int) -> LossTolerantTracker:
        """What tracks a target."""
        return LossTolerantTracker(self, anchors)

    def outputs(self, target_id: int) -> tuple[str, ...]:
        """Names of its estimates of a target."""
        return (OUTPUT,)
