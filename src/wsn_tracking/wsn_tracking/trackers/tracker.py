"""What a tracker is that needs no peers: one object a target, one `step` an epoch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any, Protocol

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.estimate import Estimate


class Tracker(Protocol):
    """Follows one target."""

    counters: Counter[str]  # input that was not used, by reason

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of its estimates."""

    def step(self, epoch: Epoch) -> tuple[Estimate, ...]:
        """The estimates of an epoch, one an output."""

    def reset(self) -> None:
        """Forget the past: as after a start."""

    def state(self) -> Mapping[str, Any]:
        """What it tells of itself in /diagnostics."""
