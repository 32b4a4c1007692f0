"""What the motes of a network say, epoch by epoch: measurements of a world, or of a recording, as payloads at the sink.

A request of a robot is measured by every node that hears it; each waits a little (they share a channel), sends, and is
relayed. The radio tells signal strengths in whole dB, ages in ms and ranges in mm, and so do these.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.parameters import param
from wsn_tracking.zstack.beacons import MODULUS as BEACONS
from wsn_tracking.zstack.duplicates import SEQ_MODULUS, TIME_MODULUS
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.lqi import Scale, lqi_of
from wsn_tracking.zstack.on_board import Judge, Thresholds, in_radius
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType, encode_payload
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.records import RangeRecord, RssiRecord, SensingRecord

MAX_IN_FRAME = 6  # records; more are decoded, none are recommended
FIRST_ADDRESS, ADDRESSES = 0x1000, 0xE000
IEEE_BASE = 0x00124B0014000000
LAST_HOP_DBM = (-85, -35)  # from the last radio into the sink
WORST_RSSI, BEST_RSSI = -127, 127
MAX_RANGE_MM = 0xFFFF


@dataclass(frozen=True)
class TrafficConfig:
    """How the motes speak."""

    payload: str = param(
        'auto',
        'what motes send: rssi (type 1), range (type 3), worn (type 4); auto: what was measured',
        choices=('auto', 'rssi', 'range', 'worn'),
    )
    delay: float = param(0.02, 'a report leaves its node up to so long after the measurement', 's', 0.0, 60.0)
    hop_time: float = param(0.004, 'what a hop takes', 's', 0.0, 1.0)
    max_hops: int = param(2, 'hops of the node that is farthest off', 'hops', 1, 30)
    heartbeat: float = param(10.0, 'how often a node says that it lives; 0: never', 's', 0.0, 86400.0)
    drift: float = param(20.0, 'crystals of the nodes are wrong by up to so much', 'ppm', 0.0, 1000.0)
    event_triggered: bool = param(False, 'the nodes trigger on board, and say so (seed 000, eq. 1 and 2)')
    y_min: float = param(-128.0, 'service radius of the nodes, until a sensing command sets it', 'dBm', -128.0, 127.0)
    e_min: float = param(0.2, 'on board: smaller changes are no news, until a command sets it', 'dB', 0.0, 100.0)
    e_max: float = param(0.6, 'on board: larger changes are noise, until a command sets it', 'dB', 0.0, 200.0)
    alpha: float = param(0.3, 'on board: weight of the past in the pre-filter', '', 0.0, 1.0)
    synchronised: bool = param(False, 'the clocks of the nodes are one, and the nodes say so')
    battery: int = param(3000, 'voltage that nodes report; 0: unknown', 'mV', 0, 5100)


class Reading(NamedTuple):
    """What one node measured of one robot's request; None is what it did not."""

    node_id: int
    rssi_dbm: float | None = None
    range_m: float | None = None
    sigma: float | None = None  # [dB] or [m]
    n_samples: int = 1


class AirEpoch(NamedTuple):
    """One request of a robot, `time_s` after the first of all."""

    time_s: float
    robot_id: int
    request_seq: int
    readings: tuple[Reading, ...]


class Message(NamedTuple):
    """A payload that reaches the sink at `time_s`; `data` stands for it where it is not what it should be."""

    time_s: float
    payload: Payload
    src: int
    mac_src: int
    hops: int
    lqi: int
    cluster: int
    endpoint: int
    was_broadcast: bool = False
    data: bytes | None = None

    @property
    def bytes(self) -> bytes:
        """What the radio carries."""
        return encode_payload(self.payload) if self.data is None else self.data


@dataclass
class Node:
    """A mote: its address, numbers and clock."""

    node_id: int
    short: int
    ieee: int
    hops: int
    relay: int  # who transmits the last hop
    last_hop_dbm: int
    thresholds: Thresholds
    seq: int = 0
    booted_s: float = 0.0  # where its clock was 0
    drift: float = 0.0
    active: bool = True
    yhat: float = math.nan  # the signal as its trigger has filtered it
    heartbeat_s: float = math.inf  # the next
    sent_s: float = -math.inf  # its last message: none leaves before it

    def clock(self, time_s: float) -> int:
        """Its clock [ms]."""
        return round((time_s - self.booted_s) * 1e3 * (1.0 + self.drift)) % TIME_MODULUS

    def number(self) -> int:
        """The number of its next message."""
        self.seq = (self.seq + 1) % SEQ_MODULUS
        return (self.seq - 1) % SEQ_MODULUS

    @property
    def mote(self) -> Mote:
        """As the sink knows it."""
        return Mote(self.short, self.ieee)


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
                self.nodes[node_id] = self._node(node_id, now)

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

    def _node(self, node_id: int, now: float) -> Node:
        draw = random.Random(f'{self._seed} node {node_id}')
        config = self._config
        short = FIRST_ADDRESS + node_id % ADDRESSES
        hops = draw.randint(1, config.max_hops)
        node = Node(
            node_id,
            short,
            IEEE_BASE + node_id,
            hops,
            relay=short if hops == 1 else FIRST_ADDRESS + ADDRESSES,
            last_hop_dbm=draw.randint(*LAST_HOP_DBM),
            thresholds=Thresholds(config.y_min, config.e_min, config.e_max),
            booted_s=now - draw.uniform(1.0, 1000.0),
            drift=draw.uniform(-config.drift, config.drift) * 1e-6,
        )
        if config.synchronised:
            node.booted_s, node.drift = 0.0, 0.0
        if config.heartbeat:
            node.heartbeat_s = now + draw.uniform(0.0, config.heartbeat)
        return node

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


def rssi_record(reading: Reading, robot_id: int, age_ms: int, beacon: int) -> RssiRecord:
    """The record of a signal strength; radios tell whole dB."""
    if reading.rssi_dbm is None or math.isnan(reading.rssi_dbm):
        rssi = None
    else:
        rssi = min(max(math.floor(reading.rssi_dbm + 0.5), WORST_RSSI), BEST_RSSI)
    sigma = None if reading.sigma is None or math.isnan(reading.sigma) else min(max(reading.sigma, 0.0), 15.8)
    return RssiRecord(robot_id, age_ms, rssi, min(reading.n_samples, 255), sigma, beacon)


def range_record(reading: Reading, robot_id: int, age_ms: int, beacon: int) -> RangeRecord:
    """The record of a range, in mm."""
    if reading.range_m is None or not 0.0 <= reading.range_m <= MAX_RANGE_MM * 1e-3:
        raise TrackingError(
            f'node {reading.node_id} has measured a range of {reading.range_m} m: expected 0 to {MAX_RANGE_MM * 1e-3} m'
        )
    sigma = 0.0 if reading.sigma is None or math.isnan(reading.sigma) else reading.sigma
    return RangeRecord(robot_id, age_ms, round(reading.range_m * 1e3), min(round(sigma * 1e3), 255), beacon)
