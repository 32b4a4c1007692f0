"""What the motes of a network say, epoch by epoch: measurements of a world, or of a recording, as payloads at the sink.

A request of a robot is measured by every node that hears it; each waits a little (they share a channel), sends, and is
relayed. Ages are told in ms.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Sequence

from wsn_tracking.zstack.beacons import MODULUS as BEACONS
from wsn_tracking.zstack.lqi import Scale, lqi_of
from wsn_tracking.zstack.motes import Message, Node, TrafficConfig, new_node
from wsn_tracking.zstack.on_board import Judge, Thresholds, in_radius
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.readings import AirEpoch, Reading, range_record, rssi_record
from wsn_tracking.zstack.records import RangeRecord, RssiRecord, SensingRecord

MAX_IN_FRAME = 6  # records; more are decoded, none are recommended


class Traffic:
    """The motes, and what they say. Draws are keyed by seed, node and epoch: nothing that goes wrong shifts them."""

    def __init__(
        self, config: TrafficConfig, radio: Radio, scale: Scale, seed: int, on_board: Judge = in_radius
    ) -> None:
        """`on_board`: the trigger of nodes that have one."""
        self.nodes: dict[int, Node] = {}
        self._judge = on_board if config.event_triggered else in_radius
        self._config = config
        self._radio = radio
        self._scale = scale
        self._seed = seed

    def join(self, ids: Iterable[int], now: float) -> None:
        """Motes that will speak."""
        for node_id in ids:
            if node_id not in self.nodes:
                self.nodes[node_id] = new_node(node_id, self._config, self._seed, now)

    def speakers(self, epoch: AirEpoch) -> list[int]:
        """Who has something to say."""
        if self._kind(epoch.readings) == PayloadType.WORN:
            return [epoch.robot_id]
        return [reading.node_id for reading in epoch.readings]

    def messages(self, epoch: AirEpoch, now: float) -> list[Message]:
        """What the nodes say of a request at `now`, in the order in which it reaches the sink."""
        self.join(self.speakers(epoch), now)
        said = self.heartbeats(now)
        kind = self._kind(epoch.readings)
        if kind == PayloadType.WORN:
            said += self._worn(epoch, now)
        else:
            by_node: dict[int, list[Reading]] = {}
            for reading in epoch.readings:
                if self.hears(reading):
                    by_node.setdefault(reading.node_id, []).append(reading)
            said += [self._report(node, epoch, readings, kind, now) for node, readings in by_node.items()]
        return sorted(said, key=lambda message: message.time_s)

    def hears(self, reading: Reading) -> bool:
        """Whether a node reports what it measured: those at rest measure nothing; signals are up to its trigger."""
        node = self.nodes[reading.node_id]
        if not node.active or reading.rssi_dbm is None or math.isnan(reading.rssi_dbm):
            return node.active
        node.yhat, is_sent = self._judge(node.thresholds, node.yhat, reading.rssi_dbm)
        return is_sent

    def heartbeats(self, now: float) -> list[Message]:
        """Those that are due."""
        said = []
        for node in self.nodes.values():
            if node.heartbeat_s <= now:
                node.heartbeat_s = now + self._config.heartbeat
                said.append(self._message(node, PayloadType.HEARTBEAT, (), now, 0.0))
        return said

    def command(self, record: SensingRecord) -> None:
        """What the host wants of a node."""
        node = self.nodes.get(record.node_id)
        if node is not None:
            node.active = bool(record.active)
            node.thresholds = Thresholds(record.y_min, record.e_min, record.e_max)

    # ---- within

    def _kind(self, readings: Sequence[Reading]) -> PayloadType:
        if self._config.payload == 'auto':
            ranges = bool(readings) and readings[0].rssi_dbm is None
            return PayloadType.RANGE if ranges else PayloadType.RSSI
        return PayloadType[self._config.payload.upper()]

    def _report(
        self, node_id: int, epoch: AirEpoch, readings: Sequence[Reading], kind: PayloadType, now: float
    ) -> Message:
        delay = self._delay(self.nodes[node_id], epoch, now)
        age, beacon = round(delay * 1e3), epoch.request_seq % BEACONS
        make = range_record if kind == PayloadType.RANGE else rssi_record
        records = tuple(make(reading, epoch.robot_id, age, beacon) for reading in readings[:MAX_IN_FRAME])
        return self._message(self.nodes[node_id], kind, records, now, delay)

    def _worn(self, epoch: AirEpoch, now: float) -> list[Message]:
        node = self.nodes[epoch.robot_id]
        delay = self._delay(node, epoch, now)
        beacon = epoch.request_seq % BEACONS
        records = [rssi_record(r, r.node_id, round(delay * 1e3), beacon) for r in epoch.readings if node.active]
        frames = [tuple(records[k : k + MAX_IN_FRAME]) for k in range(0, len(records), MAX_IN_FRAME)]
        return [self._message(node, PayloadType.WORN, frame, now, delay) for frame in frames]

    def _delay(self, node: Node, epoch: AirEpoch, now: float) -> float:
        """Measurement to sending, in whole ms, as ages are."""
        draw = random.Random(f'{self._seed} epoch {epoch.robot_id} {epoch.request_seq} of {node.node_id}')
        busy = math.ceil((node.sent_s - now) * 1e3) if node.sent_s > now else 0
        return max(math.floor(draw.uniform(0.0, self._config.delay) * 1e3), busy) / 1e3

    def _message(
        self,
        node: Node,
        kind: PayloadType,
        records: tuple[RssiRecord | RangeRecord, ...],
        now: float,
        delay: float,
    ) -> Message:
        config, node.sent_s = self._config, now + delay
        flags = Flag.EVENT_TRIGGERED * (config.event_triggered and bool(records))
        flags |= Flag.CLOCK_SYNCHRONISED * config.synchronised
        payload = Payload(
            kind, node.node_id, node.number(), node.clock(now + delay), records, int(flags), config.battery or None
        )
        time_s = now + delay + node.hops * config.hop_time
        lqi = lqi_of(node.last_hop_dbm, self._scale)
        radio = self._radio
        return Message(time_s, payload, node.short, node.relay, node.hops, lqi, radio.cluster, radio.endpoint)
