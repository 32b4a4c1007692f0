"""Whether somebody else's graph answers a feed, too: graphs of equal names in one domain mix, and their results."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

Key = tuple[int, int]  # target_id, request_seq


class Echoes:
    """Counts how often each output told an epoch: one output tells it once for every time that it was sent."""

    def __init__(self, epochs: Iterable[Key]) -> None:
        self._sent = Counter(epochs)  # a looped bag sends the same ones again
        self._told: Counter[tuple[str, Key]] = Counter()

    def is_one(self, output: str, key: Key) -> bool:
        """Note what an output told; whether that is one time too many."""
        self._told[output, key] += 1
        return key in self._sent and self._told[output, key] > self._sent[key]
