"""Parameters of the nodes that track by themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeVar

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.common import AssemblyConfig
from wsn_tracking.parameters import param
from wsn_tracking.trackers.tracker import Tracker

Checked = TypeVar('Checked', bound='TrackerNodeConfig')


@dataclass(frozen=True)
class TrackerNodeConfig(AssemblyConfig):
    """Whatever tracks by itself: what it takes; a subclass says by which tracker."""

    several: ClassVar[bool] = False  # whether it tracks every target that asks

    input: str = param(
        'auto',
        'topic that measurements come from; auto: range, rssi or observation, the first that somebody publishes',
        choices=('auto', 'range', 'rssi', 'observation'),
    )
    period: float = param(1.0, 'T, time between requests of a target', 's', 1e-3, 3600.0)

    def checked(self: Checked) -> Checked:
        """Itself, or TrackingError where fields contradict each other."""
        return self

    def tracker(self, anchors: Anchors, target_id: int) -> Tracker:
        """What tracks a target."""
        raise NotImplementedError

    def outputs(self, target_id: int) -> tuple[str, ...]:
        """Names of its estimates of a target."""
        raise NotImplementedError
