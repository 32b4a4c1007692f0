"""The base station of a simulated field: where it believes a target to be, by what it has heard alone.

A scenario takes any `Station`; the default one is as simple as can be, so that recordings do not change with trackers.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from wsn_tracking.models.anchors import Floats

GAINS = (0.4, 0.1)  # of position and, per time step, of velocity
ROUNDS = 10


class Station(Protocol):
    """Predicts positions, and hears the ranges that were measured where it predicted."""

    def predict(self, t: float) -> Floats:
        """Where the targets are (..., 2) [m] at t [s]."""

    def hear(self, t: float, positions: Floats, z: Floats) -> None:
        """Ranges z (...) [m], NaN: lost, of nodes at positions (..., 2), measured at t [s]."""


class SightLine:
    """A tracker with fixed gains: moves its belief along the line to the node by a share of what the range adds.

    It begins once `first` ranges were asked for, with a few rounds over those that came; until then it knows nothing
    (NaN).
    """

    def __init__(self, first: int, shape: tuple[int, ...] = ()) -> None:
        self._first = first
        self._x = np.full((*shape, 2), np.nan)
        self._v = np.zeros_like(self._x)
        self._t = 0.0
        self._told: list[tuple[Floats, Floats]] = []

    def predict(self, t: float) -> Floats:
        """The belief, moved on."""
        return np.asarray(self._x + self._v * (t - self._t))

    def hear(self, t: float, positions: Floats, z: Floats) -> None:
        """Move the belief along the line of sight."""
        x, dt = self.predict(t), t - self._t
        self._t = t
        if len(self._told) < self._first:
            self._told.append((positions, z))
            self._x = self._found() if len(self._told) == self._first else x
            return
        step = _step(x, positions, z)
        self._x, self._v = x + GAINS[0] * step, self._v + GAINS[1] / dt * step

    def _found(self) -> Floats:
        """From the mean of the nodes, each the heavier the nearer, towards where the ranges agree."""
        a, z = (np.stack(column) for column in zip(*self._told, strict=True))
        w = np.where(np.isnan(z), 0.0, 1.0 / np.maximum(np.nan_to_num(z), 0.1) ** 2)
        x = np.sum(w[..., None] * a, axis=0) / np.maximum(w.sum(axis=0), 1e-9)[..., None]
        for _ in range(ROUNDS):
            for positions, heard in self._told:
                x = x + GAINS[0] * _step(x, positions, heard)
        return np.asarray(x)


def _step(x: Floats, positions: Floats, z: Floats) -> Floats:
    """From x (..., 2) along the line from a node to where its range z (...) would have it; none where it is NaN."""
    offset = x - positions
    d = np.maximum(np.sqrt(np.sum(np.square(offset), axis=-1)), 1e-6)
    return np.asarray((np.where(np.isnan(z), 0.0, z - d) / d)[..., None] * offset)
