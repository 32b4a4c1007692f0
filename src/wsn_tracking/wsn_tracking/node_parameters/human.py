"""Parameters of human_tracker_node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.parameters import param
from wsn_tracking.sensing.channel_file import check_channel
from wsn_tracking.sensing.floor_plan import read_floor_plan
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import HumanConfig


@dataclass(frozen=True)
class HumanNodeConfig(HumanConfig, TrackerNodeConfig):
    """human_tracker_node."""

    system: ClassVar[str] = 'human'

    particle_rate: float = param(5.0, 'particles are published at most so often; 0: never', 'Hz', 0.0, 100.0)

    def checked(self) -> HumanNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        HumanConfig.checked(self)
        return self

    def check_files(self) -> None:
        """Raise TrackingError where a file that is named cannot be read."""
        check_channel(self.channel)
        if self.floor_plan:
            read_floor_plan(self.floor_plan)

    def tracker(self, anchors: Anchors, target_id: int) -> HumanTracker:
        """What tracks a target."""
        return HumanTracker(self, anchors)

    def outputs(self, target_id: int) -> tuple[str, ...]:
        """Names of its estimates of a target."""
        return ('human', 'human_lag') if self.lag else ('human',)
