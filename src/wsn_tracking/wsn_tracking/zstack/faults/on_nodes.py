"""Faults of the motes: numbers and clocks that wrap, restarts, and new addresses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

from wsn_tracking.zstack.commands import ZdoEndDeviceAnnceInd, encode
from wsn_tracking.zstack.duplicates import SEQ_MODULUS, TIME_MODULUS
from wsn_tracking.zstack.faults.base import Fault
from wsn_tracking.zstack.firmware.chip import TICK_MODULUS, TICK_US
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.motes import Node

MOVED = 0x0100  # how far the new address lies from the old one
ROUTER = 0x8E  # capability of a mote
SHARE = 0.5  # of the nodes are struck


class Wraps(Fault):
    """Numbers, node clocks and the sink's clock come to their ends after `value` seconds, or messages."""

    def __init__(self, value: float, seconds: float, seed: int) -> None:
        super().__init__(value, seconds, seed)
        self._known: set[int] = set()

    def first_tick(self, tick: int) -> int:
        """So that it wraps."""
        return (TICK_MODULUS - int(self.value * 1e6 / TICK_US)) % TICK_MODULUS

    def nodes(self, nodes: Mapping[int, Node], epoch: int, now: float) -> list[Frame]:
        """Motes that begin near the ends."""
        for node_id in nodes.keys() - self._known:
            self._known.add(node_id)
            self.strikes += 1
            node = nodes[node_id]
            node.seq = (SEQ_MODULUS - int(self.value)) % SEQ_MODULUS
            node.booted_s = now - (TIME_MODULUS * 1e-3 - self.value) / (1.0 + node.drift)
        return []


class AtEpoch(Fault, ABC):
    """Strikes some of the motes, at least one, in one epoch."""

    def nodes(self, nodes: Mapping[int, Node], epoch: int, now: float) -> list[Frame]:
        """Change them."""
        if epoch != int(self.value) or self.strikes or not nodes:
            return []
        struck = [nodes[k] for k in sorted(nodes) if self.random.random() < SHARE] or [nodes[min(nodes)]]
        self.strikes += len(struck)
        return [frame for node in struck for frame in self.strike(node, now)]

    @abstractmethod
    def strike(self, node: Node, now: float) -> list[Frame]:
        """Change one."""


class Reboot(AtEpoch):
    """Motes restart: their numbers and clocks begin anew."""

    def strike(self, node: Node, now: float) -> list[Frame]:
        """As after power-up, a moment ago."""
        node.seq, node.booted_s = 0, now - 0.5
        return []


class Rejoin(AtEpoch):
    """Motes lose the network and join again under another address; they go on counting."""

    def strike(self, node: Node, now: float) -> list[Frame]:
        """The sink announces them."""
        direct = node.relay == node.short
        node.short = (node.short + MOVED) & 0xFFFF
        node.relay = node.short if direct else node.relay
        return [encode(ZdoEndDeviceAnnceInd(node.short, node.short, node.ieee, ROUTER))]
