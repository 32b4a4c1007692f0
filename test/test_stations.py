"""What the bridge knows of radios, from their reports and from the neighbours that the sink tells of."""

from __future__ import annotations

import math

from wsn_tracking.nodes.stations import BROADCAST, MAX_STATIONS, Stations
from wsn_tracking.zstack.commands import Neighbour, ZdoMgmtLqiReq, ZdoMgmtLqiRsp
from wsn_tracking.zstack.payload import Payload, PayloadType
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.reports import Report

S = 1_000_000_000


def report(radio_id, src, lqi=100):
    return Report(Payload(PayloadType.HEARTBEAT, radio_id, 0, 0), src, lqi)


def neighbours(start, total, *shorts):
    rows = tuple(Neighbour(1, 0xA000 + short, short, 0, 2, 1, 77) for short in shorts)
    return ZdoMgmtLqiRsp(0, 0, total, start, rows)


def rows(stations, now=0):
    m = stations.message(now)
    columns = (m.short_addresses, m.node_ids, m.ieee_addresses, m.lqi)
    return dict(zip(m.short_addresses, zip(*(c.tolist() for c in columns), strict=True), strict=True))


def test_radio_is_what_it_said_and_its_address_what_the_sink_said():
    stations = Stations({})
    stations.see(Received(report(3, 0x1003), 1 * S))
    stations.see(Received(neighbours(0, 2, 0x1003, 0x1004), 2 * S))
    assert rows(stations) == {0x1003: (0x1003, 3, 0xB003, 100.0), 0x1004: (0x1004, 0, 0xB004, 77.0)}
    assert stations.message(5 * S).age.tolist() == [4.0, 3.0]
    stations.see(Received(report(4, 0x1004, None), 6 * S))
    assert rows(stations)[0x1004][:3] == (0x1004, 4, 0xB004)
    assert math.isnan(rows(stations)[0x1004][3])


def test_node_is_spoken_to_where_it_spoke_last_whatever_an_old_table_says():
    stations = Stations({})
    stations.see(Received(report(3, 0x1003), 1 * S))
    stations.see(Received(report(3, 0x2003), 2 * S))  # it has joined again
    stations.see(Received(neighbours(0, 1, 0x1003), 3 * S))
    assert stations.address_of(3) == 0x2003
    assert stations.address_of(9) == BROADCAST


def test_ids_are_those_of_the_node_map():
    stations = Stations({700: 3, 701: 4})
    stations.see(Received(report(700, 0x1003), 0))
    stations.see(Received(report(900, 0x1009), 0))
    assert [row[1] for row in rows(stations).values()] == [3, 0]
    assert (stations.radio_of(3), stations.radio_of(4), stations.radio_of(5)) == (700, 701, None)
    assert stations.address_of(700) == 0x1003
    assert Stations({}).radio_of(5) == 5


def test_neighbours_are_asked_for_part_by_part_and_no_longer_than_the_sink_goes_on():
    stations = Stations({})
    assert stations.question() == ZdoMgmtLqiReq(0, 0)
    assert stations.next_question(neighbours(0, 5, 1, 2)) == ZdoMgmtLqiReq(0, 2)
    assert stations.next_question(neighbours(0, 5, 1, 2)) is None  # the same part again
    assert stations.next_question(neighbours(2, 5, 3, 4)) == ZdoMgmtLqiReq(0, 4)
    assert stations.next_question(neighbours(4, 5, 5)) is None
    stations.question()
    assert stations.next_question(neighbours(0, 5)) is None
    assert stations.next_question(ZdoMgmtLqiRsp(0, 0x84)) is None
    assert stations.next_question(report(1, 2)) is None


def test_memory_is_bounded_and_keeps_who_spoke_last():
    stations = Stations({})
    for k in range(MAX_STATIONS + 5):
        stations.see(Received(report(1, k + 1), k))
        stations.see(Received(report(2, 1), k))
    assert len(rows(stations)) == MAX_STATIONS
    assert rows(stations)[1][1] == 2
