"""How far particles are from nodes, and which of them they face: one matrix product each, into kept work arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.walk import PSI, YAW, X, Y
from wsn_tracking.models.work import Work


class Geometry(NamedTuple):
    """Nodes (N,) as rows that are multiplied with columns of the particles (..., S, P)."""

    centre: Floats  # (2, 1) [m] their middle: products of coordinates cancel, so these should be small
    distance: Floats  # (N, 4): -2 A_x, -2 A_y, |A|^2, 1
    direction: Floats  # (N, 3): A_x, A_y, 1
    least_squared: float  # [m^2] no distance is shorter


def geometry(positions: Floats, height: float, least: float) -> Geometry:
    """Of nodes at positions (N, 3) and people whose nodes are worn at a height, never nearer than `least` [m]."""
    centre = positions[:, :2].mean(axis=0)
    away, one = positions[:, :2] - centre, np.ones(len(positions))
    squares = np.sum(away**2, axis=-1) + (height - positions[:, 2]) ** 2
    return Geometry(
        centre[:, None], np.column_stack([-2.0 * away, squares, one]), np.column_stack([away, one]), least**2
    )


def of_nodes(nodes: Geometry, rows: Any) -> Geometry:
    """Only some of them."""
    return nodes._replace(distance=nodes.distance[rows], direction=nodes.direction[rows])


def log_squared_distances(nodes: Geometry, s: Floats, work: Work) -> Floats:
    """ln max(d, least)^2, (..., N, P)."""
    c = work.of('columns', (*s.shape[:-2], 4, s.shape[-1]))
    x = np.subtract(s[..., X : Y + 1, :], nodes.centre, out=c[..., :2, :])
    c[..., 2, :] = 1.0
    np.einsum('...ip,...ip->...p', x, x, out=c[..., 3, :])
    d2 = np.matmul(nodes.distance, c, out=work.of('distances', _shape(nodes, s)))
    if d2.size and d2.min() < nodes.least_squared:  # looking is cheaper than clipping
        np.maximum(d2, nodes.least_squared, out=d2)
    return np.log(d2, out=d2)


def ahead(nodes: Geometry, s: Floats, work: Work) -> Floats:
    """(A - x) . u(psi) [m], (..., N, P): positive where the chest faces the node (seed 003, eq. 12)."""
    c = work.of('columns', (*s.shape[:-2], 5, s.shape[-1]))
    x, u = np.subtract(s[..., X : Y + 1, :], nodes.centre, out=c[..., 3:, :]), c[..., :2, :]
    facing = np.add(s[..., PSI, :], s[..., YAW, :], out=c[..., 2, :])
    np.cos(facing, out=c[..., 0, :])
    np.sin(facing, out=c[..., 1, :])
    np.negative(np.einsum('...ip,...ip->...p', x, u, out=c[..., 2, :]), out=c[..., 2, :])
    return np.matmul(nodes.direction, c[..., :3, :], out=work.of('ahead', _shape(nodes, s)))


def _shape(nodes: Geometry, s: Floats) -> tuple[int, ...]:
    return (*s.shape[:-2], len(nodes.distance), s.shape[-1])
