"""Which nodes measure: the cell round the place where a target is predicted to be (the base station of seed 001)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Anchors, Floats

CORNERS = 4
SAME = 1e-6  # [m] nodes that are no further apart along an axis stand in one row


class Command(NamedTuple):
    """To one node: measure, or rest (message SensingCommand, payload type 6)."""

    node_id: int
    active: bool


class CellScheduler:
    """Cells of four corner nodes each, numbered row by row from the least x and y.

    `margin` [m]: the cell that measures is kept until the prediction is so far outside, so that a target on a border
    does not toss the cells to and fro. A value: it keeps nothing of any target. Raises TrackingError for nodes that
    do not stand on a grid.
    """

    def __init__(self, anchors: Anchors, margin: float = 0.1) -> None:
        self.margin = margin
        xy = anchors.positions[:, :2]
        x, y = _lines(xy[:, 0]), _lines(xy[:, 1])
        at = {(_index(x, px), _index(y, py)): int(i) for i, (px, py) in zip(anchors.ids, xy.tolist(), strict=True)}
        if x.size < 2 or y.size < 2 or len(at) != anchors.ids.size or len(at) != x.size * y.size:
            raise TrackingError(
                f'{anchors.ids.size} nodes on {x.size} columns and {y.size} rows are no grid of cells: expected a node '
                'at every crossing of at least two columns and two rows; leave all nodes measuring instead'
            )
        self._x, self._y = x, y
        columns = x.size - 1
        cells = [(i, j) for j in range(y.size - 1) for i in range(columns)]
        order = ((0, 0), (1, 0), (1, 1), (0, 1))
        self.corners: NDArray[np.int64] = np.array(
            [[at[i + a, j + b] for a, b in order] for i, j in cells], dtype=np.int64
        )  # (cells, 4) node ids, counter-clockwise
        self.low = np.array([[x[i], y[j]] for i, j in cells])  # (cells, 2) [m]
        self.high = np.array([[x[i + 1], y[j + 1]] for i, j in cells])

    def cell(self, prediction: ArrayLike, previous: ArrayLike | None = None) -> NDArray[np.int64]:
        """The cell (...) round predicted positions (..., 2) [m]; outside the grid the nearest one."""
        p = np.asarray(prediction, dtype=np.float64)
        i = np.clip(np.searchsorted(self._x, p[..., 0], side='right') - 1, 0, self._x.size - 2)
        j = np.clip(np.searchsorted(self._y, p[..., 1], side='right') - 1, 0, self._y.size - 2)
        found = np.asarray(j * (self._x.size - 1) + i, dtype=np.int64)
        if previous is None:
            return found
        before = np.asarray(previous, dtype=np.int64)
        held = self._holds(p, before)
        return np.asarray(np.where(held, before, found))

    def node(self, cell: ArrayLike, turn: int) -> NDArray[np.int64]:
        """Id of the node (...) whose turn it is in a cell (...): its corners one after the other."""
        return np.asarray(self.corners[np.asarray(cell, dtype=np.int64), turn % CORNERS])

    def commands(self, cells: Iterable[int], previous: Iterable[int] | None = None) -> tuple[Command, ...]:
        """What is to be told when the cells (of all targets) take over from the previous ones; ascending by node.

        Only who changes is told. previous None: at first, every node is.
        """
        on = self._corners_of(cells)
        told = set(self.corners.ravel().tolist()) if previous is None else on ^ self._corners_of(previous)
        return tuple(Command(node, node in on) for node in sorted(told))

    def _corners_of(self, cells: Iterable[int]) -> set[int]:
        return {node for cell in cells for node in self.corners[cell].tolist()}

    def _holds(self, p: Floats, cell: NDArray[np.int64]) -> NDArray[np.bool_]:
        low, high = self.low[cell] - self.margin, self.high[cell] + self.margin
        return np.asarray(np.all((p >= low) & (p <= high), axis=-1))


def _lines(values: Floats) -> Floats:
    """Where the columns (or rows) stand, ascending."""
    ordered = np.sort(values)
    return np.asarray(ordered[np.concatenate([[True], np.diff(ordered) > SAME])])


def _index(lines: Floats, value: float) -> int:
    return int(np.argmin(np.abs(lines - value)))
