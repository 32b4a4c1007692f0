"""Which radios the sink hears, for the Topology message."""

from __future__ import annotations

import time
from typing import NamedTuple

from wsn_tracking_msgs import msg

from wsn_tracking.nodes import convert
from wsn_tracking.zstack.commands import ZdoMgmtLqiRsp
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.reports import Report

BROADCAST = 0xFFFF
MAX_STATIONS = 1000


class Station(NamedTuple):
    """One radio."""

    node_id: int  # 0: not known
    ieee: int  # 0: not known
    lqi: float  # NaN: not known
    heard_ns: int  # steady time of its last word


class Stations:
    """Radios by network address."""

    def __init__(self) -> None:
        self._stations: dict[int, Station] = {}

    def see(self, received: Received) -> None:
        """Whatever the link delivers; reports and neighbour tables tell of radios."""
        item, arrival_ns = received
        if isinstance(item, Report) and item.src is not None:
            lqi = float('nan') if item.lqi is None else float(item.lqi)
            self._put(item.src, item.payload.node_id, 0, lqi, arrival_ns)
        elif isinstance(item, ZdoMgmtLqiRsp):
            for neighbour in item.neighbours:
                self._put(neighbour.short, 0, neighbour.ieee, float(neighbour.lqi), arrival_ns)

    def address_of(self, node_id: int) -> int:
        """Where a node was heard last; all, where it was not."""
        known = [(s.heard_ns, address) for address, s in self._stations.items() if s.node_id == node_id]
        return max(known)[1] if known else BROADCAST

    def message(self, now_ns: int) -> msg.Topology:
        """All radios."""
        m = msg.Topology(header=convert.header(time.time_ns()))
        m.header.frame_id = ''
        stations = self._stations.values()
        m.short_addresses = list(self._stations)
        m.ieee_addresses = [s.ieee for s in stations]
        m.node_ids = [s.node_id for s in stations]
        m.lqi = [s.lqi for s in stations]
        m.age = [(now_ns - s.heard_ns) * 1e-9 for s in stations]
        return m

    def _put(self, address: int, node_id: int, ieee: int, lqi: float, heard_ns: int) -> None:
        before = self._stations.pop(address, Station(0, 0, lqi, heard_ns))
        self._stations[address] = Station(node_id or before.node_id, ieee or before.ieee, lqi, heard_ns)
        if len(self._stations) > MAX_STATIONS:
            del self._stations[next(iter(self._stations))]  # the one that was silent for longest
