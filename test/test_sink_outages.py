"""A run over a serial line whose sink restarts and is unplugged gives what is computed from what was not lost."""

from __future__ import annotations

import math
import os

import numpy as np
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from observer import observing
from radio import LIVE, PATIENCE, Radio
from wsn_tracking import graphs
from wsn_tracking.airwaves import air_epochs
from wsn_tracking.bags.estimates import differences
from wsn_tracking.bags.save import save
from wsn_tracking.nodes import convert, qos
from wsn_tracking.offline import offline
from wsn_tracking.sensing.values import EpochEnd, Request, Rssi
from wsn_tracking.simulation.record import record
from wsn_tracking.simulation.scenarios import scenario
from wsn_tracking.studies.serial import watched
from wsn_tracking.zstack.faults import Event, Happening

PART = 10  # epochs between two outages
OUTPUTS = [f'{kind}_{i}' for kind in ('local', 'fused') for i in (1, 2, 3)]


def without_outages(recording, delivered, stamps):
    """The recording as radios tell it (whole dB) with the stamps of the run, and of it only what was delivered."""
    kept = []
    for k in sorted(stamps):
        packets = [m for m in recording.messages if isinstance(m, Rssi) and m.request_seq == k]
        told = [m for m in packets if (m.node_id, k) in delivered]
        kept.append(Request(stamps[k], 1, k))
        kept += [m._replace(stamp_ns=stamps[k], rssi_dbm=math.floor(m.rssi_dbm + 0.5)) for m in told]
        sent = tuple(m.node_id for m in told), tuple(m.seq for m in told)
        kept.append(EpochEnd(stamps[k], 1, k, 'rssi', *sent, final=k == max(stamps)))
    return recording._replace(messages=tuple(kept), truth={})


def part(world, number):
    return world[number * PART : (number + 1) * PART]


class Run:
    """The live graph behind a sink, up to the estimates of everything that the line delivered."""

    def __init__(self, radio, observer):
        self.radio = radio
        self.observer = observer
        self.requests = observer.collect(msg.LocationRequest, 'request', qos.MEASUREMENTS)
        self.rssi = observer.collect(msg.RssiMeasurement, 'rssi', qos.MEASUREMENTS)
        self.link = observer.collect(msg.LinkStatus, 'link_status', qos.LATCHED_LAST)
        self.anchors = observer.collect(msg.Anchors, 'anchors', qos.LATCHED_LAST)
        self.ready = observer.collect(String, 'ready', qos.LATCHED)
        self.estimates = {
            name: observer.collect(msg.TargetEstimate, f'estimate/{name}', qos.ESTIMATES) for name in OUTPUTS
        }

    def until(self, condition, what):
        self.observer.until(condition, PATIENCE, what)

    def until_delivered(self):
        """Everything that was sent so far has passed, or is lost."""
        self.until(lambda: self.radio.loop.finished, 'all is said')
        self.until(lambda: len(self.rssi) >= len(self.radio.given), f'{len(self.radio.given)} measurements')

    def through(self, outage, world, during, after):
        """The sink falls out as one part of the world begins; the next part begins when it is back."""
        self.until_delivered()
        self.radio.do(lambda simulator, now: (simulator.happen(outage, now), simulator.go_on(part(world, during), now)))
        self.until(lambda: self.radio.loop.finished and self.radio.simulator.delivers, 'the sink is back')
        self.radio.do(lambda simulator, now: simulator.go_on(part(world, after), now))
        self.until_delivered()


def test_estimates_are_those_of_a_bag_without_the_measurements_of_the_outages(tmp_path):
    """A reset, an unplug and a replug under another name, and that once more; equal to the last bit."""
    loop = scenario('a_loop')
    recording = record(loop._replace(period=LIVE['period'], truth=loop.truth[: 7 * PART]), 1)
    world, link = air_epochs(recording), tmp_path / 'sink'
    topics = ['request', 'rssi', *(f'estimate/{name}' for name in OUTPUTS)]
    graph = watched(graphs.serial(settings={**LIVE, 'port': str(link)}), topics)
    names = {process.name for process in graph}
    radio, devices = Radio(link, part(world, 0)), []
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        radio.running(),
        live.started(graph, environment) as running,
    ):
        run = Run(radio, observer)
        run.until(lambda: live.all_run(running) and {m.data for m in run.ready} >= names, 'all are ready')
        radio.may_begin.set()
        for number, outage in enumerate((Event.RESET, Event.UNPLUG, Event.UNPLUG)):
            devices.append(os.path.realpath(link))
            run.through(Happening(outage, 0.2), world, 2 * number + 1, 2 * number + 2)
        devices.append(os.path.realpath(link))
        asked = [convert.request_value(m) for m in run.requests]
        for name, estimates in run.estimates.items():
            run.until(lambda e=estimates: bool(e) and e[-1].request_seq == asked[-1].seq, f'the last one of {name}')
    delivered = {(payload.node_id, record.beacon_seq) for payload in radio.given for record in payload.records}
    lost = {(said.payload.node_id, said.payload.records[0].beacon_seq) for said in radio.said if not said.given}
    for number in (1, 3, 5):  # each outage has cost something, and each return has brought something
        assert lost >= {(node, number * PART) for node in range(1, 13)}
        assert {request for _, request in delivered} >= set(range((number + 1) * PART, (number + 2) * PART))
    assert devices[0] == devices[1] != devices[2] != devices[3]
    assert len(run.rssi) == len(delivered) == len(radio.given)
    assert {(m.node_id, m.request_seq) for m in run.rssi} == delivered
    table = convert.anchors_value(run.anchors[0])
    np.testing.assert_allclose(table.positions, recording.anchors.positions, atol=1e-12)  # decimals of the file
    recording = recording._replace(anchors=table)

    bag = tmp_path / 'bag'
    save(bag, without_outages(recording, delivered, {r.seq: r.stamp_ns for r in asked}))
    expected = offline(*graphs.open_bag(str(bag)), 'serial_bridge', settings=LIVE)
    assert expected.epochs == len(asked) < len(world)
    for name, published in run.estimates.items():
        assert differences([convert.estimate_value(m) for m in published], expected.estimates[name]) == []
