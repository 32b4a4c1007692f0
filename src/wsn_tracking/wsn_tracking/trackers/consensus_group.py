"""Nodes of system B that live together: they hear each other at once, and the rest of the network by shares.

There is no clock in here either: whoever calls `advance` says what time it is.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator, Mapping

from wsn_tracking.sensing.values import Epoch
from wsn_tracking.trackers.consensus_door import Door
from wsn_tracking.trackers.consensus_node import ConsensusNode
from wsn_tracking.trackers.consensus_share import Share
from wsn_tracking.trackers.estimate import Estimate

MAX_QUEUE = 1000  # epochs that wait for a node which is too slow


class ConsensusGroup:
    """Nodes by id, of one configuration; each goes through its epochs in order and at its own pace.

    Round t of an epoch ends when all neighbours were heard, or head_start + (t + 1) round_timeout [s] after the epoch
    began: whoever begins a little later than the others is heard, too, and by this
    schedule a node that waits for a dead neighbour does not make those late that wait for it.
    """

    def __init__(self, nodes: Mapping[int, ConsensusNode], round_timeout: float, head_start: float = 0.0) -> None:
        self.nodes = nodes
        self._members = {i: _Member(node, round_timeout, head_start) for i, node in nodes.items()}
        self._hear: dict[int, list[int]] = {}  # who of the group takes a node's shares
        for i, node in nodes.items():
            for sender in node.neighbours:
                self._hear.setdefault(sender, []).append(i)
        self._stirred: dict[int, None] = {}  # whoever may have something to say
        self._skipped = 0

    @property
    def door(self) -> Door:
        """What shares from outside have to pass before they are received."""
        return next(iter(self.nodes.values())).door

    @property
    def foreign(self) -> tuple[int, ...]:
        """Neighbours outside the group, ascending: their shares come by `receive`."""
        return tuple(sorted(self._hear.keys() - self.nodes.keys()))

    def begin(self, epoch: Epoch) -> bool:
        """An epoch's input is complete, for every node of the group; False: it is skipped, since too many wait."""
        if any(len(member.queue) >= MAX_QUEUE for member in self._members.values()):
            self._skipped += 1
            return False
        for i, member in self._members.items():
            member.queue.append(epoch)
            self._stirred[i] = None
        return True

    def receive(self, share: Share) -> None:
        """What a node has said: one of the group, or another one that has passed the `door`."""
        for i in self._hear.get(share.node_id, ()):
            self.nodes[i].take(share)
            self._stirred[i] = None

    def advance(self, now: float) -> Iterator[Share | Estimate]:
        """What the nodes have to say by steady time `now` [s], in order: to be sent as it comes."""
        while self._stirred:
            i = next(iter(self._stirred))
            del self._stirred[i]
            for said in self._members[i].advance(now):
                if isinstance(said, Share):
                    self.receive(said)
                yield said

    def look_at_time(self, now: float) -> None:
        """Let those go on whose round has lasted too long."""
        for i, member in self._members.items():
            if member.is_late(now):
                self._stirred[i] = None

    def reset(self) -> None:
        """Forget the past: as after a start."""
        for member in self._members.values():
            member.reset()
        self._stirred.clear()

    @property
    def counters(self) -> Counter[str]:
        """The shares that were not used, by reason, and the epochs that were skipped."""
        return sum((node.counters for node in self.nodes.values()), Counter(skipped_epoch=self._skipped))

    @property
    def waits_for(self) -> str:
        """Whom the nodes still wait for in their rounds, in words."""
        awaited = sorted({j for node in self.nodes.values() for j in node.awaited})
        return f'shares of {awaited}' if awaited else ''


class _Member:
    """One node, the epochs that are before it, and when its epoch began."""

    def __init__(self, node: ConsensusNode, round_timeout: float, head_start: float) -> None:
        self.queue: deque[Epoch] = deque()
        self._node = node
        self._timeout, self._head_start = round_timeout, head_start
        self._ends: float | None = None  # when the round is over at the latest; None: in no epoch

    def is_late(self, now: float) -> bool:
        """Whether the round should be over."""
        return self._ends is not None and now >= self._ends

    def advance(self, now: float) -> Iterator[Share | Estimate]:
        """Go as far as the node can; it is heard before it goes on."""
        while True:
            if self._ends is None:
                if not self.queue:
                    return
                self._ends = now + self._head_start + self._timeout
                said = self._node.begin(self.queue.popleft())
            elif self._node.awaited and not self.is_late(now):
                return
            else:
                self._ends += self._timeout
                said = self._node.advance()
            if said is None:
                self._ends = None
                yield self._node.finish()
            else:
                yield said

    def reset(self) -> None:
        """Forget the past."""
        self._node.reset()
        self.queue.clear()
        self._ends = None
