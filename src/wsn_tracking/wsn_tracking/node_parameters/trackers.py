"""What the nodes have in common that track by themselves; each has its own parameters in a module of its name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.parameters import param
from wsn_tracking.trackers.tracker import Tracker


@dataclass(frozen=True)
class TrackerNodeConfig(AssemblyConfig, ABC):
    """Whatever tracks by itself: what it takes; a subclass says by which tracker."""

    system: ClassVar[str]
    several: ClassVar[bool] = False  # whether it tracks every target that asks

    input: str = param(
        'auto',
        'topic that measurements come from; auto: range, rssi or observation, the first that somebody publishes',
        choices=('auto', 'range', 'rssi', 'observation'),
    )
    target_height: float = param(0.0, 'height at which the target moves', 'm', -1e4, 1e4)

    def checked(self) -> TrackerNodeConfig:
        """Itself, or TrackingError where fields contradict each other."""
        return self

    def check_files(self) -> None:
        """Raise TrackingError where a file that is named cannot be read: before anything starts, not within."""

    @property
    def expected_targets(self) -> tuple[int, ...]:
        """The targets whose outputs are there from the start; -1: the first that is heard."""
        return (self.target_id,)

    def follows_another(self, count: int) -> bool:
        """Whether a target that is heard is followed, beside `count` others."""
        return False

    @abstractmethod
    def tracker(self, anchors: Anchors, target_id: int) -> Tracker:
        """What tracks a target."""

    @abstractmethod
    def outputs(self, target_id: int) -> tuple[str, ...]:
        """Names of its estimates of a target."""
