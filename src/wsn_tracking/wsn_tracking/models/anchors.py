"""The table of nodes: where they are and what their radio does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.errors import TrackingError

Floats = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]

FURTHEST = 1e8  # [m] of a coordinate: the grid of a country has its origin thousands of kilometres away
LIMITS: Mapping[str, tuple[float, float]] = {  # of what a radio can be
    'p1_dbm': (-200.0, 100.0),
    'd0': (1e-3, 1e5),
    'n': (0.01, 20.0),
    'sigma_db': (1e-6, 100.0),
    'bias': (-1e4, 1e4),
    'scale': (0.01, 100.0),
}


class Anchors(NamedTuple):
    """Measurement model table, one row a node (seed 000, section 2.1: `tables by node id`).

    Rows are ascending in `ids`. A radio reads p1_dbm - 10 n log10(d / d0) at distance d with
    standard deviation sigma_db; a ranging radio reads scale * d + bias.
    """

    ids: NDArray[np.int64]  # (N,) node ids, unique, 0..65535
    positions: Floats  # (N, 3) [m], frame map
    p1_dbm: Floats  # (N,) [dBm] at d0
    d0: Floats  # (N,) [m]
    n: Floats  # (N,) path loss exponent
    sigma_db: Floats  # (N,) [dB]
    bias: Floats  # (N,) [m]
    scale: Floats  # (N,)

    def rows(self, ids: ArrayLike) -> NDArray[np.int64]:
        """Row of each id, shape of `ids`; -1 where the id is not in the table."""
        wanted = np.asarray(ids, dtype=np.int64)
        if self.ids.size == 0:
            return np.full(wanted.shape, -1, dtype=np.int64)
        at = np.minimum(np.searchsorted(self.ids, wanted), self.ids.size - 1)
        return np.where(self.ids[at] == wanted, at, -1)

    def select(self, ids: ArrayLike) -> Anchors:
        """The table of only these nodes (raises where one is unknown)."""
        wanted = np.unique(np.asarray(ids, dtype=np.int64))
        rows = self.rows(wanted)
        if np.any(rows < 0):
            raise TrackingError(
                f'nodes {wanted[rows < 0].tolist()} are not among the anchors {self.ids.tolist()}: '
                'correct the parameter `nodes` or the anchors'
            )
        return Anchors._make(column[rows] for column in self)


def make_anchors(ids: ArrayLike, positions: ArrayLike, **radio: Any) -> Anchors:
    """Build and check a table.

    ids (N,), positions (N, 2) or (N, 3) [m]; radio: p1_dbm, d0, n, sigma_db, bias, scale, each a
    scalar or (N,), by default the radio of seed 000 (-45 dBm at 1 m, exponent 3, 1.56 dB).
    """
    ids = np.atleast_1d(np.asarray(ids, dtype=np.int64))
    if ids.size == 0:
        raise TrackingError('the anchors hold no node: at least one is expected')
    xyz = np.atleast_2d(np.asarray(positions, dtype=np.float64))
    if xyz.shape not in ((ids.size, 2), (ids.size, 3)):
        raise TrackingError(
            f'{ids.size} anchors have positions of shape {xyz.shape}: expected x, y or x, y, z for each of them'
        )
    if xyz.shape[1] == 2:
        xyz = np.column_stack([xyz, np.zeros(ids.size)])
    defaults = {'p1_dbm': -45.0, 'd0': 1.0, 'n': 3.0, 'sigma_db': 1.56, 'bias': 0.0, 'scale': 1.0}
    unknown = set(radio) - set(defaults)
    if unknown:
        raise TypeError(f'unknown radio columns {sorted(unknown)}')
    columns = {
        name: np.broadcast_to(np.asarray(radio.get(name, value), dtype=np.float64), ids.shape).copy()
        for name, value in defaults.items()
    }
    order = np.argsort(ids, kind='stable')
    table = Anchors(ids[order], xyz[order], *(column[order] for column in columns.values()))
    check(table)
    return table


def check(table: Anchors) -> None:
    """Raise TrackingError for a table that no filter may use."""
    if table.ids.size == 0:
        raise TrackingError('the anchors hold no node: at least one is expected')
    if table.positions.shape != (table.ids.size, 3):
        raise TrackingError(f'anchor positions have shape {table.positions.shape}, expected (N, 3)')
    if np.any(table.ids < 0) or np.any(table.ids > 65535):
        raise TrackingError(f'anchor ids {table.ids.tolist()} leave 0..65535')
    if np.any(np.diff(table.ids) == 0):
        doubled = table.ids[1:][np.diff(table.ids) == 0]
        raise TrackingError(f'anchor ids {doubled.tolist()} occur more than once: ids are unique')
    for name, column in table._asdict().items():
        if not np.all(np.isfinite(column)):
            raise TrackingError(f'anchor column `{name}` holds NaN or infinity: finite numbers are expected')
    if np.any(np.abs(table.positions) > FURTHEST):
        reach = np.abs(table.positions).max()
        raise TrackingError(f'anchor positions go up to {reach:g} m: expected {FURTHEST:g} m at most')
    for name, (low, high) in LIMITS.items():
        column = getattr(table, name)
        wrong = column[(column < low) | (column > high)]
        if wrong.size:
            raise TrackingError(f'anchor column `{name}` holds {wrong[0]}: expected {low:g} to {high:g}')
