"""Large batches in blocks that stay in the processor's cache, and in memory that the allocator keeps at hand."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.models.anchors import Floats

BLOCK = 4096  # filters at a time
LARGE = 2_000_000  # numbers: as much as a step on a block holds at once

Pass = Callable[[Belief, Belief, Floats, Floats], Belief]


def in_blocks(step: Pass, prior: Belief, about: Belief, z: Floats, root_R: Floats) -> Belief:
    """step(prior, about, z, root_R), whose batch axes broadcast, block after block where the batch is large.

    If `about` is the prior itself, it is so for the step, too.
    """
    batch = np.broadcast_shapes(prior.m.shape[:-1], about.m.shape[:-1], z.shape[:-1], root_R.shape[:-1])
    size = int(np.prod(batch))
    _keep_freed_memory()
    if size <= BLOCK:
        return step(prior, about, z, root_R)

    def flat(array: Floats, own: int = 1) -> Floats:
        shape = array.shape[array.ndim - own :]
        return np.broadcast_to(array, batch + shape).reshape(size, *shape)

    def belief(b: Belief) -> Belief:
        return Belief(flat(b.m), flat(b.chol_P, 2))

    flat_prior, flat_z, flat_R = belief(prior), flat(z), flat(root_R)
    flat_about = flat_prior if about is prior else belief(about)
    m, chol_P = np.empty(flat_prior.m.shape), np.empty(flat_prior.chol_P.shape)
    ends = np.linspace(0, size, -(-size // BLOCK) + 1).astype(int).tolist()
    for rows in map(slice, ends[:-1], ends[1:]):
        own = Belief(flat_prior.m[rows], flat_prior.chol_P[rows])
        other = own if about is prior else Belief(flat_about.m[rows], flat_about.chol_P[rows])
        m[rows], chol_P[rows] = step(own, other, flat_z[rows], flat_R[rows])
    return Belief(m.reshape(batch + m.shape[1:]), chol_P.reshape(batch + chol_P.shape[1:]))


@cache
def _keep_freed_memory() -> None:
    """Have the allocator keep arrays that are freed, for those that follow.

    glibc returns what is larger than 128 KiB to the system, which makes each page anew. Whatever larger piece is freed
    moves that limit up to its size; no page of this one is ever touched.
    """
    np.empty(LARGE)
