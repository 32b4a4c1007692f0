"""Random draws keyed by who draws and when, so that a restart or a lost epoch shifts nothing."""

from __future__ import annotations

import numpy as np

WORD = 2**64


def keyed(seed: int, who: int, epoch: int) -> np.random.Generator:
    """Generator of its own for (seed, who, epoch), from the counter-based Philox.

    Seed and who are the key, the epoch is the highest word of the counter: streams never overlap.
    """
    key = np.array([seed % WORD, who % WORD], dtype=np.uint64)  # of plain lists, NumPy rounds large words to floats
    counter = np.array([0, 0, 0, epoch % WORD], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))
