"""The tracks of a node: an assembly and a tracker for every target that it follows."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.trackers import TrackerNodeConfig
from wsn_tracking.nodes.assembly import TICK, Assembly
from wsn_tracking.sensing.values import Epoch, EpochEnd
from wsn_tracking.trackers.tracker import Tracker

Then = Callable[[Tracker, Epoch], None]


class Track:
    """One target: its epochs in order, and what follows it."""

    def __init__(self, node: Node, config: TrackerNodeConfig, target_id: int, then: Then) -> None:
        self.tracker: Tracker | None = None
        self._config, self._then = config, then
        self._anchors: Anchors | None = None
        own = dataclasses.replace(config, target_id=target_id)
        self.assembly = Assembly(node, own, self._step, self._anew, timed=False)

    def start(self, anchors: Anchors) -> None:
        """The anchors are known."""
        self._anchors = anchors
        if (target := self.assembly.target_id) >= 0:
            self.tracker = self._config.tracker(anchors, target)
        self.assembly.start(anchors, anchors.ids.tolist())

    @property
    def has_ended(self) -> bool:
        """Whether the last epoch of the target's feed is done."""
        return self.assembly.final_seq is not None and self.assembly.last_seq == self.assembly.final_seq

    def _step(self, epoch: Epoch) -> None:
        if self.tracker is None:  # the first target that is heard is followed
            assert self._anchors is not None
            self.tracker = self._config.tracker(self._anchors, epoch.target_id)
        self._then(self.tracker, epoch)

    def _anew(self) -> None:
        if self.tracker is not None:
            self.tracker.reset()


class Tracks:
    """Routes messages to the track of their target; a target that is new gets one, where several may be followed.

    No message changes another target's track.
    """

    def __init__(self, node: Node, config: TrackerNodeConfig, then: Then) -> None:
        self._node, self._config, self._then = node, config, then
        self._anchors: Anchors | None = None
        self._other = 0
        self.by_target: dict[int, Track] = {}
        for target in config.expected_targets:
            self._add(target)
        node.create_timer(TICK, self._advance)

    def start(self, anchors: Anchors) -> None:
        """The anchors are known."""
        self._anchors = anchors
        for track in [*self.by_target.values()]:
            track.start(anchors)

    def request(self, message: Any, now: float) -> None:
        """A Request."""
        if track := self._of(message):
            track.assembly.request(message, now)

    def measurement(self, message: Any, now: float) -> None:
        """A measurement."""
        if track := self._of(message):
            track.assembly.measurement(message, now)

    def listing(self, message: Any, now: float) -> None:
        """What was sent: an EpochEnd or a TriggerReport."""
        if track := self._of(message):
            track.assembly.listing(message, now)

    def end(self, end: EpochEnd, now: float, *, lists: bool) -> None:
        """An EpochEnd; `lists`: of the measurements that are taken here."""
        if track := self._of(end):
            track.assembly.end(end, now, lists=lists)

    @property
    def have_ended(self) -> bool:
        """Whether every target's feed has ended, and all of it is done."""
        return bool(self.by_target) and all(track.has_ended for track in self.by_target.values())

    @property
    def last_seq(self) -> int:
        """The epoch that was done last; of several targets, of one that has not ended."""
        tracks = sorted(self.by_target.values(), key=lambda track: track.has_ended)
        return tracks[0].assembly.last_seq if tracks else -1

    @property
    def waits_for(self) -> str:
        """What the oldest open epochs still lack, in words."""
        if self._anchors is None:
            return 'anchors'
        return '; '.join(filter(None, (track.assembly.waits_for for track in self.by_target.values())))

    @property
    def counters(self) -> Counter[str]:
        """What was used and what was not, the latter under `dropped.` and its reason."""
        total: Counter[str] = Counter({'dropped.other_target': self._other})
        for track in self.by_target.values():
            total.update(track.assembly.counters)
            if track.tracker is not None:
                gated = 'gated'  # all else that a tracker drops, its assembly has counted
                total.update({f'dropped.{gated}' if k == gated else k: n for k, n in track.tracker.counters.items()})
        return total

    def _of(self, message: Any) -> Track | None:
        if not self._config.several:
            return self.by_target[self._config.target_id]
        if message.target_id not in self.by_target:
            if not self._config.follows_another(len(self.by_target)):
                self._other += 1
                return None
            self._add(message.target_id)
        return self.by_target[message.target_id]

    def _add(self, target_id: int) -> None:
        track = self.by_target[target_id] = Track(self._node, self._config, target_id, self._then)
        if self._anchors is not None:
            track.start(self._anchors)

    def _advance(self) -> None:
        for track in [*self.by_target.values()]:
            track.assembly.advance()
