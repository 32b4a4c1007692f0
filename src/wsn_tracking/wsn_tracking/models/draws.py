"""Random draws keyed by who draws and when, so that a restart or a lost epoch shifts nothing."""

from __future__ import annotations

import numpy as np

WORD = 2**64


def keyed(seed: int, who: int, epoch: int) -> np.random.Generator:
    """Generator of its own for (seed, who, epoch), from the counter-based Philox.

    Seed and who are the key, the epoch is the highest word of the counter: streams never overlap.
    """
    bits = np.random.Philox(key=[seed % WORD, who % WORD], counter=[0, 0, 0, epoch % WORD])
    return np.random.Generator(bits)
