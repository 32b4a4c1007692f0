"""Which shares a node lets in: what nobody of its network can have said is neither averaged nor forwarded."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.information import is_semidefinite, unpacked
from wsn_tracking.trackers.consensus_config import ConsensusConfig
from wsn_tracking.trackers.consensus_share import ROW, STATES, Share, bitmap

LARGEST = 1e20  # of a number in a share: far beyond what any radio can know, far below what overflows
LIKE = {'icf': ('icf', 'chebyshev'), 'chebyshev': ('chebyshev', 'icf')}  # schemes that average the same thing


class Door:
    """What nodes of one configuration and table of anchors can say. `ids`: the nodes that there are."""

    def __init__(self, config: ConsensusConfig, ids: Iterable[int]) -> None:
        self._scheme, self._rounds = config.scheme, config.rounds
        self._ids = frozenset(ids)
        self._others = ~bitmap(self._ids)

    def check(self, share: Share) -> Share:
        """The share itself, or TrackingError with what was seen and what was expected."""
        wrong = self._wrong_head(share) or self._wrong_numbers(share)
        if wrong:
            who = f'share of node {share.node_id}, epoch {share.request_seq}, round {share.round}'
            raise TrackingError(f'{who} {wrong}')
        return share

    def _wrong_head(self, share: Share) -> str:
        expected = LIKE.get(self._scheme, (self._scheme,))
        if share.scheme not in expected:
            return f'is of scheme {share.scheme!r}, expected {self._scheme!r}: configure all nodes alike'
        if share.round >= self._rounds:
            return f'is beyond the {self._rounds} rounds of an epoch: configure all nodes alike'
        if share.degree >= len(self._ids):
            return f'claims {share.degree} neighbours: there are {len(self._ids)} nodes'
        strange = sorted(set(share.item_ids) - self._ids)
        if strange or int.from_bytes(share.live, 'little') & self._others:
            return f'tells of nodes {strange or "in its bitmap"} that the anchors do not name: give all nodes one table'
        return ''

    def _wrong_numbers(self, share: Share) -> str:
        numbers = share.information_vector, share.information, share.items
        seen = tuple(map(len, numbers))
        expected = (0, 0, ROW * len(share.item_ids)) if self._scheme == 'flood' else (STATES, ROW - STATES, 0)
        if seen != expected or (self._scheme != 'flood' and share.item_ids):
            return f'has {seen} numbers in vector, triangle and items, expected {expected}'
        rows = np.array(sum(numbers, ())).reshape(-1, ROW)
        if not np.all(np.abs(rows) <= LARGEST):
            return f'holds NaN, infinity or more than {LARGEST:g}: expected finite numbers'
        if self._scheme != 'chebyshev' and not np.all(is_semidefinite(unpacked(rows))):  # accelerated rows overshoot
            return 'holds an information matrix with a negative eigenvalue: nobody knows less than nothing'
        return ''
