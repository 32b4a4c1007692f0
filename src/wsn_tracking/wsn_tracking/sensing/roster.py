"""The nodes of an epoch: whose packets count, what a list says of them, and whose lists are waited for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from wsn_tracking.sensing.open_epochs import Key, Listing
from wsn_tracking.sensing.values import EpochEnd

FORGET_AFTER = 3  # epochs without its report, and a node is no longer waited for


class Roster:
    """`nodes` count; others that are `known` (the nodes, where not told) are no strangers."""

    def __init__(self, nodes: Iterable[int], known: Iterable[int] | None = None) -> None:
        self.nodes = frozenset(nodes)
        self._known = self.nodes if known is None else frozenset(known)
        self._unreported: Counter[int] = Counter()  # epochs in a row

    def refuses(self, node: int) -> str:
        """The reason why its packets do not count; empty where they do."""
        if node in self.nodes:
            return ''
        return 'other_node' if node in self._known else 'unknown_node'

    def covered(self, listing: Listing) -> frozenset[int]:
        """The nodes that a list speaks for: an EpochEnd for all, a report for those that it names."""
        if isinstance(listing, EpochEnd):
            return self.nodes
        return self.nodes & {*listing.sent_ids, *listing.silent_ids}

    def sent(self, listing: Listing) -> set[Key]:
        """The packets that a list names."""
        if isinstance(listing, EpochEnd):
            named = zip(listing.node_ids, listing.seqs, strict=False)
        else:
            named = zip(listing.sent_ids, listing.sent_seqs, strict=False)
        return {key for key in named if key[0] in self.nodes}

    @property
    def awaited(self) -> frozenset[int]:
        """The nodes whose lists are waited for; where nobody speaks, only time can tell that all has come."""
        if not self._unreported:
            return self.nodes
        return self.nodes - {node for node, n in self._unreported.items() if n >= FORGET_AFTER} or self.nodes

    def heard(self, nodes: Iterable[int]) -> None:
        """They speak again, be it late."""
        for node in nodes:
            self._unreported.pop(node, None)

    def missed(self, nodes: Iterable[int]) -> None:
        """An epoch was closed without their lists."""
        self._unreported.update(nodes)

    def begin_anew(self) -> None:
        """All are waited for."""
        self._unreported.clear()
