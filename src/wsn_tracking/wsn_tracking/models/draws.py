"""Random draws keyed by who draws and when, so that a restart or a lost epoch shifts nothing."""

from __future__ import annotations

from typing import Any

import numpy as np

WORD = 2**64


def keyed(seed: int, who: int, epoch: int) -> np.random.Generator:
    """Generator of its own for (seed, who, epoch), from the counter-based Philox.

    Seed and who are the key, the epoch is the highest word of the counter: streams never overlap.
    """
    key = np.array([seed % WORD, who % WORD], dtype=np.uint64)  # of plain lists, NumPy rounds large words to floats
    counter = np.array([0, 0, 0, epoch % WORD], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


class Stream:
    """The draws of one `who`, epoch by epoch: those of `keyed` at a fifth of the time, for whoever draws at every step.

    It has one generator, which is set to an epoch: take an epoch's draws before the next one is asked for.
    """

    def __init__(self, seed: int, who: int) -> None:
        self._generator = keyed(seed, who, 0)
        self._state: dict[str, Any] = {
            **self._generator.bit_generator.state,
            'state': {'key': [seed % WORD, who % WORD], 'counter': [0, 0, 0, 0]},
        }

    def at(self, epoch: int) -> np.random.Generator:
        """The generator, as `keyed` gives it for that epoch."""
        self._state['state']['counter'][3] = epoch % WORD
        self._generator.bit_generator.state = self._state
        return self._generator
