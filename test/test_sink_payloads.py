"""Every type of payload, up and down, through a simulated sink on a pseudo terminal and serial_bridge_node."""

from __future__ import annotations

import contextlib
import dataclasses
import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from sink_cases import epochs
from std_msgs.msg import String
from wsn_tracking_msgs import msg

import live
from observer import observing
from radio import LIVE, PATIENCE, QUIET, Radio
from wsn_tracking.graphs import Process
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.health import WARN
from wsn_tracking.parameters import specs
from wsn_tracking.sensing.values import Modality, Reason
from wsn_tracking.trackers.estimate import Kind
from wsn_tracking.zstack.readings import AirEpoch, Reading
from wsn_tracking.zstack.records import FeedbackRecord, SensingRecord

KNOWN = {spec.name for spec in specs(SerialBridgeConfig)}


class Bridge:
    """A bridge that is attached to a simulated sink, and an observer of what it publishes."""

    def __init__(self, radio, observer):
        self.radio = radio
        self.observer = observer
        self.taken = {
            topic: observer.collect(kind, topic, profile)
            for topic, kind, profile in (
                ('request', msg.LocationRequest, qos.MEASUREMENTS),
                ('rssi', msg.RssiMeasurement, qos.MEASUREMENTS),
                ('range', msg.RangeMeasurement, qos.MEASUREMENTS),
                ('epoch_end', msg.EpochEnd, qos.MEASUREMENTS),
                ('trigger_report', msg.TriggerReport, qos.MEASUREMENTS),
                ('topology', msg.Topology, qos.LATCHED_LAST),
                ('link_status', msg.LinkStatus, qos.LATCHED_LAST),
            )
        }
        self.ready = observer.collect(String, 'ready', qos.LATCHED)

    def until(self, condition, what):
        self.observer.until(condition, PATIENCE, what)

    def come(self, topic, count):
        """The messages of a topic, when there are so many."""
        messages = self.taken[topic]
        self.until(lambda: len(messages) >= count, f'{count} on {topic}')
        return messages

    def tell(self, kind, topic):
        """Publishes on a topic that the bridge listens to."""
        publisher = self.observer.node.create_publisher(kind, topic, qos.ESTIMATES)
        self.until(lambda: publisher.get_subscription_count() == 1, f'the bridge takes {topic}')
        return publisher.publish

    def told(self, count):
        """What the sink sent to the nodes."""
        self.until(lambda: len(self.radio.simulator.told) >= count, f'{count} messages to nodes')
        return list(self.radio.simulator.told)


@pytest.fixture
def bridged(tmp_path):
    """Starts a sink with a world behind it and a bridge; the world begins when the bridge is ready."""
    with contextlib.ExitStack() as stack:

        def start(world, settings=(), **config):
            link = tmp_path / 'sink'
            environment = stack.enter_context(live.private_domain())
            observer = stack.enter_context(observing(environment))
            radio = Radio(link, world, **config)
            stack.enter_context(radio.running())
            bridge = Bridge(radio, observer)
            values = {name: value for name, value in LIVE.items() if name in KNOWN}
            topics = [f'{topic}=1' for topic in ('request', 'rssi', 'range', 'epoch_end', 'trigger_report')]
            given = {
                **values,
                'epoch_timeout': 1.0,
                'port': str(link),
                'expected_subscribers': topics,
                **dict(settings),
            }
            process = Process('serial_bridge_node', 'bridge', given)
            running = stack.enter_context(live.started([process], environment))
            bridge.until(lambda: live.all_run(running) and bridge.ready, 'the bridge is ready')
            radio.may_begin.set()
            return bridge

        yield start


def test_signal_strengths_become_measurements(bridged):
    """Type 1, of two robots."""
    world = sorted([*epochs(3, robot=1), *epochs(3, robot=2)], key=lambda e: e.time_s)
    bridge = bridged(world, rate=20.0)
    heard = [convert.rssi_value(m) for m in bridge.come('rssi', 24)]
    assert sorted((m.node_id, m.target_id, m.request_seq, m.rssi_dbm) for m in heard) == sorted(
        (r.node_id, e.robot_id, e.request_seq, math.floor(r.rssi_dbm + 0.5)) for e in world for r in e.readings
    )
    ends = [convert.epoch_end_value(m) for m in bridge.come('epoch_end', 6)]
    assert sorted((e.target_id, e.request_seq) for e in ends) == [(t, k) for t in (1, 2) for k in range(3)]
    assert len(bridge.come('request', 6)) == 6


def test_heartbeats_tell_of_radios(bridged):
    """Type 2: nodes that measure nothing are in the topology all the same."""
    traffic = dataclasses.replace(QUIET, heartbeat=0.05)
    silent = [AirEpoch(0.1 * k, 1, k, (Reading(1, rssi_dbm=math.nan),)) for k in range(5)]
    bridge = bridged(
        [AirEpoch(0.0, 1, 0, (Reading(1, rssi_dbm=-50.0), Reading(7, rssi_dbm=-60.0))), *silent[1:]], traffic=traffic
    )
    said, tables = bridge.radio.said, bridge.taken['topology']
    bridge.until(lambda: {(s.payload.type, s.payload.node_id) for s in said} >= {(2, 1), (2, 7)}, 'their heartbeats')
    bridge.until(lambda: tables and {1, 7} <= set(tables[-1].node_ids), 'both')
    table = bridge.taken['topology'][-1]
    assert len(table.short_addresses) == len(table.lqi) == len(table.age)
    assert min(table.age) >= 0.0


def test_ranges_become_measurements(bridged):
    """Type 3, in millimetres, of the modality that the bridge is told."""
    world = [AirEpoch(float(k), 2, k, (Reading(5, range_m=1.2344 + k, sigma=0.0121),)) for k in range(3)]
    bridge = bridged(world, {'range_modality': int(Modality.UWB)}, rate=20.0)
    heard = [convert.range_value(m) for m in bridge.come('range', 3)]
    assert [(m.node_id, m.target_id, m.request_seq, m.modality) for m in heard] == [(5, 2, k, 2) for k in range(3)]
    assert [m.range for m in heard] == pytest.approx([1.234, 2.234, 3.234])
    assert [m.variance for m in heard] == pytest.approx([0.012**2] * 3)
    assert {m.topic for m in bridge.come('epoch_end', 3)} == {'range'}


def test_worn_node_is_the_target(bridged):
    """Type 4, several frames a period: the person bears the node, the references are the nodes."""
    world = epochs(3, nodes=14, robot=77)
    bridge = bridged(world, traffic=dataclasses.replace(QUIET, payload='worn'), rate=20.0)
    heard = bridge.come('rssi', 42)
    assert {m.target_id for m in heard} == {77}
    assert sorted((m.node_id, m.request_seq) for m in heard) == [(n, k) for n in range(1, 15) for k in range(3)]
    assert sorted(bridge.come('epoch_end', 3)[0].node_ids) == list(range(1, 15))


def test_estimates_are_fed_back_to_the_robots(bridged):
    """Type 5, in cm and units of 2 cm/s."""
    bridge = bridged([], {'feedback': True})
    tell = bridge.tell(msg.TargetEstimate, 'feedback')
    m = msg.TargetEstimate(target_id=9, source='fused_1', state_names=['x', 'y', 'vx', 'vy'], kind=1)
    m.mean, m.covariance, m.contributors = [1.234, -0.567, 0.061, -0.04], np.eye(4).ravel().tolist(), [1]
    bridge.until(lambda: bridge.taken['link_status'] and bridge.taken['link_status'][-1].connected, 'the link')
    tell(m)
    (told,) = bridge.told(1)
    assert told.dst == 0xFFFF
    assert told.record == FeedbackRecord(9, 1.23, -0.57, pytest.approx(0.06), pytest.approx(-0.04))


def test_feedback_comes_from_topics_that_are_named_no_oftener_than_asked_for_and_never_by_guess(bridged):
    """A target that is still looked for is told nothing; of epochs at 20 Hz every second one is."""
    topics = ['estimate/hybrid_target_1', 'estimate/hybrid_target_2']
    bridge = bridged([], {'feedback': True, 'feedback_topics': topics, 'feedback_period': 0.1})
    tell = dict(zip((1, 2), (bridge.tell(msg.TargetEstimate, topic) for topic in topics), strict=True))
    bridge.until(lambda: bridge.taken['link_status'] and bridge.taken['link_status'][-1].connected, 'the link')
    for k in range(6):
        for target, kind in ((1, Kind.START if k < 2 else Kind.LOCAL), (2, Kind.START)):
            m = msg.TargetEstimate(target_id=target, source='x', state_names=['x', 'y', 'vx', 'vy'], kind=int(kind))
            m.header.stamp.nanosec = 50_000_000 * k + 3_000_000 * (k % 2)
            m.mean, m.covariance = [0.1 * k, 0.0, 0.0, 0.0], np.eye(4).ravel().tolist()
            tell[target](m)
    assert [told.record.x for told in bridge.told(2)] == pytest.approx([0.2, 0.4])


def changing(first, count, second=-60.0):
    """Node 1 changes by 1 dB each time."""
    return [
        AirEpoch(0.1 * k, 1, k, (Reading(1, rssi_dbm=-50.0 - k), Reading(2, rssi_dbm=second)))
        for k in range(first, first + count)
    ]


def test_commands_set_the_trigger_on_board_and_send_nodes_to_rest(bridged):
    """Type 6: nodes that do not send until they are told; one that is silent is reported, one at rest says nothing."""
    traffic = dataclasses.replace(QUIET, event_triggered=True, e_min=90.0, e_max=99.0)
    bridge = bridged(changing(0, 3), {'sensing_command': True}, traffic=traffic)
    radio = bridge.radio
    tell = bridge.tell(msg.SensingCommand, 'sensing_command')
    bridge.until(lambda: radio.loop.finished, 'the first part')
    assert radio.said == []
    tell(msg.SensingCommand(node_id=1, active=True, y_min=-90, e_min=0.1, e_max=2.5))
    bridge.told(1)
    radio.do(lambda s, now: s.go_on(changing(3, 3), now))
    assert [(m.node_id, m.rssi_dbm) for m in bridge.come('rssi', 3)] == [(1, -53.0), (1, -54.0), (1, -55.0)]
    reports = [convert.report_value(m) for m in bridge.come('trigger_report', 3)]
    assert [(r.sent_ids, r.silent_ids) for r in reports] == [((1,), ())] * 3

    tell(msg.SensingCommand(node_id=2, active=True, y_min=-90, e_min=0.1, e_max=2.5))
    bridge.told(2)
    radio.do(lambda s, now: s.go_on(changing(6, 1, -61.0), now))
    assert convert.report_value(bridge.come('trigger_report', 4)[-1]).sent_ids == (1, 2)
    radio.do(lambda s, now: s.go_on(changing(7, 1, -30.0), now))  # a change that is noise to node 2
    silent = convert.report_value(bridge.come('trigger_report', 5)[-1])
    assert (silent.sent_ids, silent.silent_ids, silent.reasons) == ((1,), (2,), (Reason.ON_BOARD,))

    tell(msg.SensingCommand(node_id=1, active=False, y_min=-90, e_min=0.1, e_max=2.5))
    assert bridge.told(3)[-1].record == SensingRecord(1, 0, -90, pytest.approx(0.1), pytest.approx(2.5))
    before = len(radio.said)
    radio.do(lambda s, now: s.go_on(changing(8, 2), now))
    bridge.until(lambda: radio.loop.finished, 'the last part')
    assert 1 not in {said.payload.node_id for said in radio.said[before:]}


def test_topology_is_the_whole_table_of_the_sink_under_the_names_of_the_map(bridged):
    """Radios 101 to 107 are nodes 1 to 7; the sink tells of two neighbours at a time; 107 never speaks."""
    readings = [Reading(100 + n, rssi_dbm=-40.0 - n) for n in range(1, 7)]
    world = [AirEpoch(0.1 * k, 1, k, (*readings, Reading(107, rssi_dbm=-80.0))) for k in range(3)]
    names = [f'{100 + n}={n}' for n in range(1, 8)]
    traffic = dataclasses.replace(QUIET, y_min=-70.0)
    bridge = bridged(world, {'node_map': names, 'topology_period': 0.2, 'sensing_command': True}, traffic=traffic)
    radio, tables = bridge.radio, bridge.taken['topology']
    assert {m.node_id for m in bridge.come('rssi', 18)} == set(range(1, 7))
    bridge.until(lambda: tables and len(set(tables[-1].ieee_addresses) - {0}) == 8, '7 motes and the robot')
    assert set(tables[-1].node_ids) == {0, 1, 2, 3, 4, 5, 6}
    tell = bridge.tell(msg.SensingCommand, 'sensing_command')
    tell(msg.SensingCommand(node_id=3, active=False, y_min=-90, e_min=0.1, e_max=2.5))
    (told,) = bridge.told(1)
    assert (told.record.node_id, told.dst) == (103, radio.simulator.traffic.nodes[103].short)


def test_beside_sensing_nodes_the_report_tells_of_the_silent_alone(bridged):
    """They report which ranges they send; whoever takes ranges would wait for one of each signal strength listed."""
    traffic = dataclasses.replace(QUIET, event_triggered=True, e_min=0.1, e_max=2.5)
    bridge = bridged(changing(0, 2), traffic=traffic)
    radio, reports = bridge.radio, bridge.taken['trigger_report']
    bridge.until(lambda: radio.loop.finished, 'the first part')
    assert bridge.come('trigger_report', 1)[0].sent_ids.tolist() == [1]
    radio.do(lambda s, now: s.go_on(changing(2, 1, -61.0), now))
    assert bridge.come('trigger_report', 2)[-1].sent_ids.tolist() == [1, 2]
    sensing = bridge.observer.node
    sensing.create_publisher(msg.TriggerReport, 'trigger_report', qos.MEASUREMENTS)
    first = 3
    while len(reports[-1].sent_ids):  # until the bridge knows of it
        bridge.until(lambda: radio.loop.finished, 'the part before')
        radio.do(lambda s, now, k=first: s.go_on(changing(k, 1, -61.0), now))
        bridge.come('trigger_report', first)
        first += 1
    told = convert.report_value(reports[-1])
    assert (told.sent_ids, told.sent_seqs, told.silent_ids, told.reasons) == ((), (), (2,), (Reason.ON_BOARD,))


def test_what_misleads_without_any_other_sign_is_warned_of(bridged):
    """Two radios of one id; LQIs that no radio of the configured scale gives."""
    bridge = bridged(epochs(20, nodes=12), faults=('two_addresses=1',), lqi_scale='cc26x2', rate=20.0)
    arrays = bridge.observer.collect(DiagnosticArray, '/diagnostics', 10)

    def said():
        statuses = [status for array in arrays for status in array.status]
        return [status.message for status in statuses if status.level == WARN]

    bridge.until(lambda: any('two radios bear the id' in m and 'set lqi_scale to cc26x2' in m for m in said()), 'both')
