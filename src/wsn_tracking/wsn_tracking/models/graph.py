"""Who hears whom: graphs of nodes as matrices (..., N, N), True where two are neighbours."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats, Mask


def adjacency(positions: Floats, radius: float) -> Mask:
    """Neighbours within the radio radius [m], (..., N, N) of positions (..., N, 2 or 3); nobody is its own."""
    d = positions[..., :, None, :] - positions[..., None, :, :]
    near = np.sum(d * d, axis=-1) <= radius * radius
    return np.asarray(near & ~np.eye(positions.shape[-2], dtype=np.bool_))


def degrees(graph: Mask) -> Floats:
    """Number of neighbours, (..., N)."""
    return np.asarray(graph.sum(axis=-1, dtype=np.float64))


def reached(graph: Mask, hops: int) -> Mask:
    """Of whom each node has heard after so many hops, itself included, (..., N, N)."""
    N = graph.shape[-1]
    out = np.broadcast_to(np.eye(N, dtype=np.bool_), graph.shape)
    step = graph | out
    for bit in f'{min(hops, N):b}':  # after N hops there is nobody left to reach
        out = _joined(out, out)
        if bit == '1':
            out = _joined(out, step)
    return out


def component_sizes(graph: Mask) -> Floats:
    """Number of nodes that each node can reach, itself included, (..., N)."""
    return np.asarray(reached(graph, graph.shape[-1]).sum(axis=-1, dtype=np.float64))


def is_connected(graph: Mask) -> Mask:
    """Whether everybody can reach everybody, (...)."""
    return np.asarray(np.all(component_sizes(graph) == graph.shape[-1], axis=-1))


def diameter(graph: Mask) -> int:
    """Hops after which nobody (of any graph of the batch) hears of anybody new."""
    hops, known = 0, reached(graph, 0)
    step = graph | known
    while not np.array_equal(more := _joined(known, step), known):
        hops, known = hops + 1, more
    return hops


def _joined(A: Mask, B: Mask) -> Mask:
    """The product of two relations; in floats, where a matrix product is fast."""
    return np.asarray(A.astype(np.float32) @ B.astype(np.float32) > 0.5)
