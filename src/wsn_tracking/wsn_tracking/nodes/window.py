"""How far a feed may run ahead of the outputs that it feeds."""

from __future__ import annotations

import bisect
from collections.abc import Mapping, Sequence


class Window:
    """Epochs by index; each watched output reports which one it has reached.

    `topics` tells each output's target, -1 where that is not known: other targets' epochs pass it by, those before its
    first included. An output that is silent for `timeout` [s] while epochs wait for it is given up: it is not waited
    for any more, until it speaks again.
    """

    def __init__(self, topics: Mapping[str, int], epochs: Sequence[tuple[int, int]], size: int, timeout: float) -> None:
        self._size, self._timeout = size, timeout
        self._last = len(epochs) - 1
        self._indices: dict[tuple[int, int], list[int]] = {}  # where an epoch is: at several places in a looped bag
        for index, key in enumerate(epochs):
            self._indices.setdefault(key, []).append(index)
        self._settled = list(range(len(epochs)))
        following: dict[int, int] = {}
        for index in reversed(range(len(epochs))):
            target_id = epochs[index][0]
            self._settled[index] = following.get(target_id, len(epochs)) - 1
            following[target_id] = index
        firsts = {target: index - 1 for target, index in following.items()}
        self._reached = {t: -1 if target < 0 else firsts.get(target, self._last) for t, target in topics.items()}
        self._spoke: dict[str, float] = {}
        self._front = -1
        self.given_up: set[str] = set()
        self._absent: set[str] = set()

    def begin(self, now: float) -> None:
        """The feed starts at steady time `now` [s]."""
        self._spoke = dict.fromkeys(self._reached, now)

    def heard(self, topic: str, target_id: int, request_seq: int, now: float) -> None:
        """An output has reached an epoch."""
        self._spoke[topic] = now
        self._absent.discard(topic)
        places = self._indices.get((target_id, request_seq), [])
        at = bisect.bisect_right(places, self._front) - 1
        if at >= 0:
            self._reached[topic] = max(self._reached[topic], self._settled[places[at]])

    def admits(self, epoch: int, now: float) -> bool:
        """Whether messages of this epoch may be sent; remembers the furthest that was."""
        awaited = [reached for topic, reached in self._reached.items() if topic not in self._absent]
        if awaited and epoch - min(awaited) > self._size:
            return False
        if epoch > self._front:
            self._wake(now)
            self._front = epoch
        return True

    def silent(self, now: float) -> list[str]:
        """The outputs that are given up at this moment."""
        lost = [
            topic
            for topic, reached in self._reached.items()
            if topic not in self._absent and reached < self._front and now - self._spoke[topic] > self._timeout
        ]
        self._absent.update(lost)
        self.given_up.update(lost)
        return lost

    def finished(self) -> bool:
        """Whether every output that is waited for has reached the last epoch."""
        return all(r >= self._last for topic, r in self._reached.items() if topic not in self._absent)

    def state(self) -> dict[str, int]:
        """Epoch index that the feed and each output has reached."""
        return {'epoch': self._front, **{f'reached.{topic}': reached for topic, reached in self._reached.items()}}

    def _wake(self, now: float) -> None:
        """An output that was level with the feed is silent only from now on."""
        for topic, reached in self._reached.items():
            if reached >= self._front:
                self._spoke[topic] = now
