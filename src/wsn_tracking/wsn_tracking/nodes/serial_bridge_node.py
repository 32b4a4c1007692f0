"""serial_bridge_node: a real sink on a serial line in, requests, measurements and epoch ends out."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Any

from wsn_tracking_msgs import msg

from wsn_tracking.bridging import Bridge, Rules, Value
from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.serial import SerialBridgeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import TrackingNode, run
from wsn_tracking.nodes.health import OK, Health, link, radio, worst
from wsn_tracking.nodes.stations import Stations
from wsn_tracking.sensing.values import EpochEnd, Range, Request, Rssi, TriggerReport
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.zstack.commands import COORDINATOR_UP, ZdoMgmtLqiReq, ZdoMgmtLqiReqRsp
from wsn_tracking.zstack.intake import Intake
from wsn_tracking.zstack.link import Status
from wsn_tracking.zstack.lqi import SCALES, scale_words
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.records import FeedbackRecord, Record, SensingRecord
from wsn_tracking.zstack.session import Session

TICK = 0.01  # [s] how often epochs are looked at that are over
JITTER = 0.1  # of a period by which stamps may come early
STUCK_NS = 1_000_000_000  # an epoch does not wait longer for a look at the line
WARNED = 60.0  # [s] for which two radios of one id are told of
OUTPUTS = {
    Request: ('request', msg.LocationRequest, convert.request_message),
    Rssi: ('rssi', msg.RssiMeasurement, convert.rssi_message),
    Range: ('range', msg.RangeMeasurement, convert.range_message),
    EpochEnd: ('epoch_end', msg.EpochEnd, convert.epoch_end_message),
    TriggerReport: ('trigger_report', msg.TriggerReport, convert.report_message),
}


class SerialBridgeNode(TrackingNode[SerialBridgeConfig]):
    """Takes what the session of the sink delivers, and publishes what it means."""

    def __init__(self) -> None:
        super().__init__('serial_bridge_node', SerialBridgeConfig)
        config = self.config
        node_ids = node_map(config.node_map)
        rules = Rules(round(config.ends_after * 1e9), config.range_modality, node_ids)
        self._bridge = Bridge(rules, time.time_ns() - time.monotonic_ns())
        self._intake = Intake(config, SCALES[config.lqi_scale])
        self._stations = Stations(node_ids)
        self._sent_down = 0
        self._fed_back: dict[int, int] = {}  # target -> stamp [ns] of what was told last
        self._conflicts: dict[int, float] = {}  # node -> when two radios last bore its id
        self._logged = ''  # what was last said of the link
        self._outputs = {kind: self.give(cls, topic, qos.MEASUREMENTS) for kind, (topic, cls, _) in OUTPUTS.items()}
        self._link = self.create_publisher(msg.LinkStatus, 'link_status', qos.LATCHED_LAST)
        self._topology = self.create_publisher(msg.Topology, 'topology', qos.LATCHED_LAST)
        if config.anchors.ids:
            table = convert.anchors_message(config.anchors.table, time.time_ns())
            self.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST).publish(table)
        for topic in filter(None, config.feedback_topics if config.feedback else ()):
            self.take(msg.TargetEstimate, topic, convert.peer_value, self._feed_back, qos.ESTIMATES)
        if config.sensing_command:
            self.take(msg.SensingCommand, 'sensing_command', lambda m: m, self._command, qos.ESTIMATES)
        self.create_timer(TICK, self._end_epochs)
        self.create_timer(1.0, self._tell_link)
        if config.topology_period:
            self.create_timer(config.topology_period, lambda: self._ask_topology(self._stations.question()))
        woken = self.create_guard_condition(self._take_all)
        self._session = Session(config, woken.trigger)
        self._session.start()

    def destroy_node(self) -> None:
        """Give the port back first: nobody may wake a node that is gone."""
        self._session.close()
        super().destroy_node()

    # ---- up

    def _take_all(self) -> None:
        for received in self._session.inbox.take():
            self._stations.see(received)
            self._ask_topology(self._stations.next_question(received.item))
            taken = self._intake.take(received)
            if taken is not None:
                if taken.judged.conflict:
                    self._conflicts[taken.report.payload.node_id] = time.monotonic()
                self._publish(self._bridge.take(taken, received.arrival_ns))

    def _end_epochs(self) -> None:
        """Those that are over; what the line had delivered by then counts, however late this process looks at it."""
        due_ns, now_ns = self._bridge.next_due_ns, time.monotonic_ns()
        if due_ns is None or due_ns > now_ns:
            return
        looked_ns = self._session.looked_ns
        if looked_ns is None or now_ns - due_ns > STUCK_NS:  # nothing is to come, or the line is stuck
            looked_ns = now_ns
        if looked_ns < due_ns:
            self._session.look()
            return
        self._take_all()
        self._publish(self._bridge.due(looked_ns))

    def _publish(self, values: Iterable[Value]) -> None:
        for value in map(self._as_told, values):
            to_message: Any = OUTPUTS[type(value)][2]
            self._outputs[type(value)].publish(to_message(value))
            if isinstance(value, Request):
                self._last_input['request'] = time.monotonic()

    def _as_told(self, value: Value) -> Value:
        """Where sensing nodes report which ranges they send, the motes' own report tells of the silent alone."""
        if isinstance(value, TriggerReport) and self.count_publishers('trigger_report') > 1:
            return value._replace(sent_ids=(), sent_seqs=())
        return value

    # ---- down

    def _feed_back(self, estimate: Estimate, now: float) -> None:
        if estimate.kind == Kind.START:  # nobody knows yet where it is
            return
        last = self._fed_back.get(estimate.target_id, 0)
        if 0 <= estimate.stamp_ns - last < (1.0 - JITTER) * self.config.feedback_period * 1e9:
            return
        self._fed_back[estimate.target_id] = estimate.stamp_ns
        x, y, vx, vy = estimate.mean.tolist()
        self._send(PayloadType.FEEDBACK, FeedbackRecord(estimate.target_id, x, y, vx, vy), self.config.feedback_address)

    def _command(self, m: msg.SensingCommand, now: float) -> None:
        radio_id = self._stations.radio_of(m.node_id)
        if radio_id is None:
            self.malformed['sensing_command'] += 1
            words = f'node {m.node_id} is not in `node_map`: no radio is told'
            self.get_logger().warning(words, throttle_duration_sec=5.0)
            return
        record = SensingRecord(radio_id, int(m.active), m.y_min, m.e_min, m.e_max)
        self._send(PayloadType.COMMAND, record, self._stations.address_of(radio_id))

    def _send(self, kind: PayloadType, record: Record, address: int) -> None:
        try:
            data = encode_payload(
                Payload(kind, 0, self._sent_down % 65536, int(time.monotonic() * 1e3) % 2**32, (record,))
            )
        except TrackingError as error:
            self.malformed['feedback' if kind == PayloadType.FEEDBACK else 'sensing_command'] += 1
            self.get_logger().warning(str(error), throttle_duration_sec=5.0)
            return
        self._sent_down += 1
        self._session.send(address, data)

    # ---- what is told of the line

    def _ask_topology(self, question: ZdoMgmtLqiReq | None) -> None:
        if question is not None:
            self._session.ask(question, ZdoMgmtLqiReqRsp)

    def _tell_link(self) -> None:
        status, counters = self._session.status, self._counters()
        m = msg.LinkStatus(
            header=convert.header(time.time_ns()), port=status.device or status.port, connected=status.up
        )
        m.header.frame_id = ''
        m.firmware = str(status.sink.version or '') if status.sink else ''
        m.device_state = self._device_state(status)
        m.channel = 0 if status.network is None else status.network.channel
        m.pan_id = 0xFFFF if status.network is None else status.network.pan_id
        m.counter_names, m.counters = list(counters), list(counters.values())
        self._link.publish(m)
        self._log(status)
        self._topology.publish(self._stations.message(time.monotonic_ns()))

    def _device_state(self, status: Status) -> int:
        """As told; a sink that does not tell was attached to only when it was up."""
        if status.network is not None:
            return status.network.state
        return COORDINATOR_UP if status.up and self.config.sink_protocol == 'znp' else 0

    def _log(self, status: Status) -> None:
        """Whoever looks at the terminal reads why there is no link, once, and that there is one."""
        words = f'the sink is at {status.device}' if status.up else status.error
        if not words or words == self._logged:
            return
        self._logged = words
        if status.up:
            self.get_logger().info(words)
        else:
            self.get_logger().warning(words)

    def _counters(self) -> dict[str, int]:
        return {**self._session.counters, **self._intake.counters, **self._bridge.counters}

    def health(self) -> Health:
        """The link; requests that stopped; what is wrong with the radios."""
        now = time.monotonic()
        conflicting = [node for node, then in self._conflicts.items() if now - then < WARNED]
        strange = self._intake.counters['lqi_unreachable'] > 0
        radios = radio(conflicting, scale_words(self._intake.lqis, self.config.lqi_scale) if strange else '')
        if radios.level != OK:
            self.get_logger().warning(radios.sentence, throttle_duration_sec=WARNED)
        return worst(link(self._session.status.up, self._session.status.error, super().health()), radios)

    def state(self) -> Mapping[str, Any]:
        """Every counter of the line."""
        return {'phase': self._session.status.phase, 'sent down': self._sent_down, **self._counters()}


def node_map(entries: Iterable[str]) -> dict[int, int]:
    """radio=node entries; TrackingError for any other."""
    ids = {}
    for entry in filter(None, entries):
        radio, _, node = entry.partition('=')
        if not (radio.isdecimal() and node.isdecimal() and int(radio) < 65536 and int(node) < 65536):
            raise TrackingError(f'parameter `node_map` holds {entry!r}: expected radio=node, e.g. 4660=3')
        ids[int(radio)] = int(node)
    return ids


def main() -> None:
    """Run the node."""
    run(SerialBridgeNode)
