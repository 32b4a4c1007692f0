"""The epochs of a world in their order, and when each is due."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.readings import AirEpoch


class Course:
    """`rate`: how much faster than the clock they follow each other; 0: at once."""

    def __init__(self, epochs: Sequence[AirEpoch], rate: float) -> None:
        self.epochs = list(epochs)
        self.sent: list[float] = []  # when each was sent, so far
        self._rate = rate

    @property
    def to_come(self) -> int:
        """How many were not sent yet."""
        return len(self.epochs) - len(self.sent)

    def after(self, index: int) -> float:
        """How long after the first one an epoch is due [s]."""
        return (self.epochs[index].time_s - self.epochs[0].time_s) / self._rate if self._rate else 0.0

    def extend(self, epochs: Sequence[AirEpoch]) -> int:
        """More of them; the index of the first. TrackingError where some are still to come."""
        if self.to_come:
            raise TrackingError(f'epochs still to come: {self.to_come}; wait for them')
        first = len(self.epochs)
        self.epochs += epochs
        return first
