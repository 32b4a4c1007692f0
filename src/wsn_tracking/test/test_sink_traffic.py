"""What simulated motes say: measurements arrive as they were made, as far as the radio can tell them."""

import dataclasses
import math

import numpy as np
import pytest
from sink_cases import QUIET, Host, epochs, expected

from wsn_tracking.airwaves import air_epochs, on_board, recording_of
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing import trigger
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.intake import Intake
from wsn_tracking.zstack.lqi import SCALES, reachable
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType, encode_payload
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.readings import AirEpoch, Reading
from wsn_tracking.zstack.records import FeedbackRecord, SensingRecord


def taken(host):
    """The reports as the host's intake judges them."""
    intake = Intake(ClockConfig(), SCALES['cc2530'])
    received = [Received(item, round(t * 1e9)) for item, t in zip(host.items, host.times, strict=True)]
    return [t for t in map(intake.take, received) if t is not None], intake.counters


@pytest.mark.parametrize('protocol', ['znp', 'mt_app', 'ascii'])
def test_every_measurement_arrives_over_every_kind_of_sink(protocol):
    world = epochs(20, nodes=12)
    host = Host(world, sink_protocol=protocol).run()
    if protocol == 'ascii':
        heard = sorted((r.payload.node_id, r.payload.records[0].rssi_dbm) for r in host.reports)
        assert heard == sorted((node, rssi) for node, _, rssi in expected(world))
    else:
        assert host.heard() == expected(world)
    assert host.bad() == []


def test_scenario_arrives_rounded_to_whole_db_and_in_its_time():
    world = air_epochs(recording_of('a_loop', '', 3))
    host = Host(world).run(limit=200.0)
    assert host.heard() == sorted(
        (r.node_id, e.request_seq % 256, math.floor(r.rssi_dbm + 0.5)) for e in world for r in e.readings
    )
    reports, counters = taken(host)
    assert not any(counters.values()), counters
    start = host.simulator.sent[0]
    for each in reports:
        (record,) = each.report.payload.records
        measured = each.measured_ns(record.age_ms) * 1e-9
        nearest = round(measured - start)
        assert nearest % 256 == record.beacon_seq
        assert measured - start - nearest == pytest.approx(0.0, abs=0.02)  # hops, ticks, and the host's step


def test_epochs_come_at_the_rate_that_is_asked_for():
    host = Host(epochs(11), rate=4.0).run()
    assert host.simulator.sent == pytest.approx([host.simulator.sent[0] + 0.25 * k for k in range(11)])
    at_once = Host(epochs(11), rate=0.0).run()
    assert at_once.simulator.sent == [at_once.simulator.sent[0]] * 11
    assert at_once.heard() == expected(epochs(11))


def test_speed_of_the_line_paces_what_is_said():
    slow = Host(epochs(3, nodes=12), rate=0.0, baud=38400).run()
    line = [(t, a) for t, a in slow.actions if isinstance(a, bytes)][-36:]
    lasted = line[-1][0] - line[0][0]
    assert lasted >= sum(len(a) for _, a in line[:-1]) * 10 / 38400 - 1e-6
    assert slow.heard() == expected(epochs(3, nodes=12))


def test_reports_bear_what_the_radio_knows():
    host = Host(epochs(5, nodes=12)).run()
    for report in host.reports:
        assert 1 <= report.hops <= 2
        assert report.direct == (report.hops == 1)
        assert report.lqi in reachable(SCALES['cc2530'])
        assert report.payload.battery_mv == 3000
        assert report.payload.flags == 0
    assert len({report.src for report in host.reports}) == 12


def test_numbers_of_a_node_are_consecutive_and_its_clock_goes_on():
    host = Host(epochs(30), traffic=dataclasses.replace(QUIET, heartbeat=2.0)).run()
    kinds = set()
    for node in range(1, 5):
        mine = [report.payload for report in host.reports if report.payload.node_id == node]
        assert [payload.seq for payload in mine] == list(range(len(mine)))
        clocks = [payload.t_ms for payload in mine]
        assert clocks == sorted(clocks)
        kinds |= {payload.type for payload in mine}
    assert kinds == {PayloadType.RSSI, PayloadType.HEARTBEAT}


def test_flags_of_motes_that_trigger_and_share_a_clock():
    traffic = dataclasses.replace(QUIET, event_triggered=True, synchronised=True)
    host = Host(epochs(3), traffic=traffic).run()
    assert {r.payload.flags for r in host.reports} == {Flag.EVENT_TRIGGERED | Flag.CLOCK_SYNCHRONISED}


def test_motes_trigger_on_board_before_they_round():
    """What is sent is what the document's trigger sends of the signals as they are, epoch by epoch and node by node."""
    world = air_epochs(recording_of('a_loop', '', 3))
    traffic = dataclasses.replace(QUIET, event_triggered=True, y_min=-55.0, alpha=0.3)
    host = Host(world, traffic=traffic, on_board=on_board(0.3)).run(limit=200.0)
    ids = sorted({r.node_id for epoch in world for r in epoch.readings})
    step = trigger.event(trigger.EventThresholds(-55.0, 0.2, 0.6, 0.3))
    yhat, sent = np.full(len(ids), np.nan), []
    for epoch in world:
        heard = {r.node_id: r.rssi_dbm for r in epoch.readings}
        y = np.array([heard.get(node, np.nan) for node in ids])
        yhat, verdicts = step(yhat, y, np.zeros(len(ids)))
        chosen = np.flatnonzero(verdicts == trigger.SENT)
        sent += [(ids[i], epoch.request_seq % 256, math.floor(y[i] + 0.5)) for i in chosen]
    assert 100 < len(sent) < 1000
    assert host.heard() == sorted(sent)


def test_command_sets_the_thresholds_of_the_trigger_on_board():
    """A step of 0.5 dB is a change of 0.15 dB to a filter with alpha 0.3: below e_min, until a command lowers it."""
    world = [
        AirEpoch(float(k), 1, k, (Reading(1, rssi_dbm=-50.0 - 0.5 * k), Reading(2, rssi_dbm=-50.0))) for k in range(8)
    ]
    traffic = dataclasses.replace(QUIET, event_triggered=True, e_min=1.0, e_max=2.0)
    host = Host(world, traffic=traffic, on_board=on_board(0.3))
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 3.5)
    assert host.reports == []
    command = SensingRecord(1, 1, -90, 0.1, 2.0)
    payload = encode_payload(Payload(PayloadType.COMMAND, 0, 1, 0, (command,)))
    host.say(c.AfDataRequest(0x1001, 0xE8, 0xE8, 0x10, 1, 0, 30, payload))
    host.until(host.now + 4.5)
    assert [(node, beacon) for node, beacon, _ in host.heard()] == [(1, 4), (1, 5), (1, 6), (1, 7)]


def test_world_goes_on_after_its_end():
    host = Host(epochs(3), rate=10.0).run()
    more = [e._replace(time_s=e.time_s + 5.0, request_seq=e.request_seq + 3) for e in epochs(2)]
    began = host.now
    host.simulator.go_on(more, host.now)
    assert not host.simulator.finished
    with pytest.raises(TrackingError, match='still to come: 1;'):  # the first of the two was due at once
        host.simulator.go_on(more, host.now)
    host.until(host.now + 1.0)
    assert host.simulator.finished
    assert host.heard() == expected([*epochs(3), *more])
    assert host.simulator.sent[3:] == pytest.approx([began, began + 0.1])


# ---- down


def down(kind, record, dst=0xFFFF):
    data = encode_payload(Payload(kind, 0, 1, 0, (record,)))
    return c.AfDataRequest(dst, 0xE8, 0xE8, 0x10, 5, 0, 30, data)


def test_commands_of_the_host_are_obeyed_and_told():
    host = Host(epochs(6))
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 2.5)
    rest, feedback = SensingRecord(2, 0, -128, 0.0, 0.0), FeedbackRecord(1, 1.0, 2.0, 0.1, 0.0)
    host.say(
        down(PayloadType.COMMAND, rest),
        down(PayloadType.COMMAND, SensingRecord(3, 1, -42, 0.0, 0.0), dst=0x1003),
        down(PayloadType.FEEDBACK, feedback, dst=0xF101),
        down(PayloadType.FEEDBACK, feedback, dst=0x0BAD),
    )
    host.until(host.now + 10.0)
    assert [(told.dst, told.record) for told in host.simulator.told] == [
        (0xFFFF, rest),
        (0x1003, SensingRecord(3, 1, -42, 0.0, 0.0)),
        (0xF101, feedback),
    ]
    assert [confirm.status for confirm in host.of(c.AfDataConfirm)] == [0, 0, 0, 0xCD]
    count = {node: sum(r.payload.node_id == node for r in host.reports) for node in range(1, 5)}
    assert count == {1: 6, 2: 3, 3: 3, 4: 6}


def test_what_the_nodes_do_not_understand_is_counted():
    host = Host(epochs(1))
    host.attach()
    host.say(c.AfDataRequest(0xFFFF, 0xE8, 0xE8, 0x10, 5, 0, 30, b'nonsense'))
    assert host.simulator.counters['not_understood'] == 1
