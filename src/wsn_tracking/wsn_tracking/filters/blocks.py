"""Large batches in blocks that fit the processor's cache, and that the allocator keeps at hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Floats

BLOCK = 128


def in_blocks(step: Callable[..., Belief], arrays: Sequence[Floats], own: Sequence[int]) -> Belief:
    """step(*arrays), computed block after block where the batch is large.

    `own` says how many trailing axes of each array belong to one element; those before are the batch and broadcast. An
    array that is given twice is given to the step as the same object twice.
    """
    if max(array.size for array in arrays) <= BLOCK:  # surely small
        return step(*arrays)
    batch = np.broadcast_shapes(*(array.shape[: array.ndim - k] for array, k in zip(arrays, own, strict=True)))
    size = int(np.prod(batch))
    if size <= BLOCK:
        return step(*arrays)
    flat = {
        id(array): np.broadcast_to(array, batch + array.shape[array.ndim - k :]).reshape(
            size, *array.shape[array.ndim - k :]
        )
        for array, k in zip(arrays, own, strict=True)
    }
    m, chol_P = (np.empty((size, *arrays[i].shape[arrays[i].ndim - own[i] :])) for i in (0, 1))
    for start in range(0, size, BLOCK):
        rows = slice(start, start + BLOCK)
        cut = {key: array[rows] for key, array in flat.items()}
        m[rows], chol_P[rows] = step(*(cut[id(array)] for array in arrays))
    return Belief(m.reshape(*batch, *m.shape[1:]), chol_P.reshape(*batch, *chol_P.shape[1:]))
