"""Which radios the sink hears, for the Topology message."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import NamedTuple

from wsn_tracking_msgs import msg

from wsn_tracking.nodes import convert
from wsn_tracking.zstack.commands import ZdoMgmtLqiReq, ZdoMgmtLqiRsp
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.reports import Report

BROADCAST = 0xFFFF
SINK = 0
MAX_STATIONS = 1000


class Station(NamedTuple):
    """One radio."""

    radio_id: int | None  # as it calls itself; None: it has not spoken
    ieee: int  # 0: not known
    lqi: float  # NaN: not known
    heard_ns: int  # steady time of its last word; of one that has not spoken: since when it is known


class Stations:
    """Radios by network address; `node_ids`: radio id -> node id, empty where they are the same."""

    def __init__(self, node_ids: Mapping[int, int]) -> None:
        self._node_ids = node_ids
        self._stations: dict[int, Station] = {}
        self._part = 0  # of the sink's neighbours that was asked for, by the number of its first

    def see(self, received: Received) -> None:
        """Whatever the link delivers; reports and neighbour tables tell of radios."""
        item, arrival_ns = received
        if isinstance(item, Report) and item.src is not None:
            known = self._stations.pop(item.src, None)
            lqi = float('nan') if item.lqi is None else float(item.lqi)
            self._put(item.src, Station(item.payload.node_id, known.ieee if known else 0, lqi, arrival_ns))
        elif isinstance(item, ZdoMgmtLqiRsp):
            for neighbour in item.neighbours:  # of old, perhaps: only what a radio has said itself is news of it
                new = Station(None, neighbour.ieee, float(neighbour.lqi), arrival_ns)
                known = self._stations.get(neighbour.short, new)
                self._put(neighbour.short, known._replace(ieee=neighbour.ieee))

    def question(self) -> ZdoMgmtLqiReq:
        """For the first of the sink's neighbours."""
        self._part = 0
        return ZdoMgmtLqiReq(SINK, self._part)

    def next_question(self, item: object) -> ZdoMgmtLqiReq | None:
        """For the next of them, where an answer is a part of them; a sink that answers something else is left alone."""
        if not isinstance(item, ZdoMgmtLqiRsp) or (item.src, item.start) != (SINK, self._part):
            return None
        self._part += len(item.neighbours)
        is_last = not item.neighbours or self._part >= (item.total or 0)
        return None if is_last else ZdoMgmtLqiReq(SINK, self._part)

    def radio_of(self, node_id: int) -> int | None:
        """What the radio of a node calls itself; None where no radio is mapped to it."""
        if not self._node_ids:
            return node_id
        return next((radio for radio, node in self._node_ids.items() if node == node_id), None)

    def address_of(self, radio_id: int) -> int:
        """Where a radio was heard last; all, where it was not."""
        known = [(s.heard_ns, address) for address, s in self._stations.items() if s.radio_id == radio_id]
        return max(known)[1] if known else BROADCAST

    def message(self, now_ns: int) -> msg.Topology:
        """All radios."""
        m = msg.Topology(header=convert.header(time.time_ns()))
        m.header.frame_id = ''
        stations = self._stations.values()
        m.short_addresses = list(self._stations)
        m.ieee_addresses = [s.ieee for s in stations]
        m.node_ids = [self._node_of(s.radio_id) for s in stations]
        m.lqi = [s.lqi for s in stations]
        m.age = [(now_ns - s.heard_ns) * 1e-9 for s in stations]
        return m

    def _node_of(self, radio_id: int | None) -> int:
        """The node of a radio; 0 where it is not known."""
        return (self._node_ids.get(radio_id, 0) if self._node_ids else radio_id) if radio_id is not None else 0

    def _put(self, address: int, station: Station) -> None:
        self._stations[address] = station
        if len(self._stations) > MAX_STATIONS:
            del self._stations[next(iter(self._stations))]  # the one that was silent for longest
