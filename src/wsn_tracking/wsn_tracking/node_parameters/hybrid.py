"""Parameters of hybrid_tracker_node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.parameters import param
from wsn_tracking.sensing.channel_file import check_channel
from wsn_tracking.trackers.hybrid import HybridTracker
from wsn_tracking.trackers.hybrid_config import HybridConfig


@dataclass(frozen=True)
class HybridNodeConfig(HybridConfig, TrackerNodeConfig):
    """hybrid_tracker_node."""

    system: ClassVar[str] = 'hybrid'
    several: ClassVar[bool] = True

    targets: tuple[int, ...] = param((), 'the targets that are tracked; empty: every one that is heard', 'id', 0, 65535)
    schedule: bool = param(
        False,
        'tell the nodes, on `sensing_command`, who measures: the cells of four round where the targets are predicted '
        'to be, and all nodes while one is looked for. They have to stand on a grid',
    )
    most_targets: int = param(100, 'no more targets than these are tracked', '', 1, 65536)

    @property
    def expected_targets(self) -> tuple[int, ...]:
        """The targets whose outputs are there from the start."""
        return self.targets if self.target_id < 0 else (self.target_id,)

    def checked(self) -> HybridNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        HybridConfig.checked(self)
        check_channel(self.channel)
        return self

    def follows_another(self, count: int) -> bool:
        """Whether a target that is heard is followed, beside `count` others."""
        return not self.expected_targets and count < self.most_targets

    def tracker(self, anchors: Anchors, target_id: int) -> HybridTracker:
        """What tracks a target."""
        return HybridTracker(self, anchors, target_id)

    def outputs(self, target_id: int) -> tuple[str, ...]:
        """Names of its estimates of a target."""
        return (f'hybrid_target_{target_id}',)
