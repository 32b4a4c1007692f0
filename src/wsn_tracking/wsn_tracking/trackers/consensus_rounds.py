"""The rounds of one node within one epoch: what it sends next, from what it has heard.

Rows are packed information (14,). Whoever is heard comes in the order of the ids, so that the order in which shares
arrive changes nothing, not even the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple, Protocol

import numpy as np

from wsn_tracking.fusion.consensus import accelerated, average_of_neighbours
from wsn_tracking.models.anchors import Floats
from wsn_tracking.trackers.consensus_share import ROW, STATES, Share


class Payload(NamedTuple):
    """The fields of a share that depend on the scheme."""

    scheme: str
    information_vector: tuple[float, ...] = ()
    information: tuple[float, ...] = ()
    item_ids: tuple[int, ...] = ()
    items: tuple[float, ...] = ()


class Rounds(Protocol):
    """One epoch of a scheme."""

    def payload(self) -> Payload:
        """What is sent in the round to come."""
        ...

    def close(self, shares: Sequence[Share], degree: int, *, missed: bool) -> None:
        """Close a round with what was heard, ascending by node; `missed`: some neighbour was not."""
        ...

    @property
    def value(self) -> Floats:
        """What the rounds so far give, (14,)."""
        ...

    @property
    def plain(self) -> Floats:
        """The same, had the last round not been accelerated."""
        ...

    @property
    def before(self) -> Floats:
        """The same without the last round."""
        ...


class Averaging:
    """Weighted averages of the neighbours' rows; with `omegas` accelerated, until anything is missed or said to be."""

    def __init__(self, name: str, row: Floats, omegas: Sequence[float] = (), *, fallen_back: bool = False) -> None:
        self._name = name
        self._omegas = omegas
        self._plainly = fallen_back or not omegas
        self._round = 0
        self.value = self.plain = self.before = row

    def payload(self) -> Payload:
        """The row as it stands; a node that has fallen back says so."""
        numbers = self.value.tolist()
        name = 'icf' if self._omegas and self._plainly else self._name
        return Payload(name, tuple(numbers[:STATES]), tuple(numbers[STATES:]))

    def close(self, shares: Sequence[Share], degree: int, *, missed: bool) -> None:
        """Average (seed 002, eq. 13); the weight of who was not heard stays with the node itself."""
        before, own = self.before, self.value
        self.before = self.plain = own
        if shares:
            weights = np.array([1.0 / (1.0 + max(degree, share.degree)) for share in shares])
            rows = np.array([share.information_vector + share.information for share in shares])
            self.plain = average_of_neighbours(own, rows, weights)
        self._plainly = self._plainly or missed or any(share.scheme != self._name for share in shares)
        omega = 1.0 if self._plainly else self._omegas[self._round]
        self.value = accelerated(self.plain, before, omega) if omega != 1.0 else self.plain
        self._round += 1


class Flooding:
    """Every node's row, forwarded once and counted once."""

    def __init__(self, name: str, row: Floats, node_id: int) -> None:
        self._name = name
        self._known = {node_id: tuple(row.tolist())}
        self._news: tuple[int, ...] = (node_id,)
        self._before: tuple[int, ...] = (node_id,)

    def payload(self) -> Payload:
        """What was heard for the first time in the round before."""
        return Payload(
            self._name, item_ids=self._news, items=tuple(chain.from_iterable(self._known[i] for i in self._news))
        )

    def close(self, shares: Sequence[Share], degree: int, *, missed: bool) -> None:
        """Take in whose row was not known; of two that differ, the one from the lowest id."""
        self._before = tuple(self._known)
        for share in shares:
            for at, i in enumerate(share.item_ids):
                if i not in self._known:
                    self._known[i] = share.items[ROW * at : ROW * (at + 1)]
        self._news = tuple(sorted(self._known.keys() - set(self._before)))

    @property
    def ids(self) -> tuple[int, ...]:
        """Whose rows have come through, ascending."""
        return tuple(sorted(self._known))

    @property
    def value(self) -> Floats:
        """The sum of all rows, in the order of the ids."""
        return self._sum(self.ids)

    @property
    def plain(self) -> Floats:
        """Nothing is accelerated here."""
        return self.value

    @property
    def before(self) -> Floats:
        """The sum without what came in the last round."""
        return self._sum(sorted(self._before))

    def _sum(self, ids: Sequence[int]) -> Floats:
        return np.asarray(np.sum([self._known[i] for i in ids], axis=0))
