"""What is to be done at which time; things of the same time in the order in which they were put down."""

from __future__ import annotations

import heapq
import itertools
from typing import Generic, TypeVar

Job = TypeVar('Job')


class Agenda(Generic[Job]):
    """Jobs by time [s]."""

    def __init__(self) -> None:
        self._jobs: list[tuple[float, int, Job]] = []
        self._numbers = itertools.count()

    def at(self, time_s: float, job: Job) -> None:
        """Put a job down."""
        heapq.heappush(self._jobs, (time_s, next(self._numbers), job))

    @property
    def due(self) -> float:
        """When the first is due."""
        return self._jobs[0][0] if self._jobs else float('inf')

    def take(self) -> tuple[float, Job]:
        """The first one, and when it was due."""
        time_s, _, job = heapq.heappop(self._jobs)
        return time_s, job

    def clear(self) -> None:
        """Nothing is to be done."""
        self._jobs.clear()
