"""The motes of a network: how they speak, their addresses, numbers and clocks; and messages as the sink gets them."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import NamedTuple

from wsn_tracking.parameters import param
from wsn_tracking.zstack.duplicates import SEQ_MODULUS, TIME_MODULUS
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.on_board import Thresholds
from wsn_tracking.zstack.payload import Payload, encode_payload

FIRST_ADDRESS, ADDRESSES = 0x1000, 0xE000
IEEE_BASE = 0x00124B0014000000
LAST_HOP_DBM = (-85, -35)  # from the last radio into the sink


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


def new_node(node_id: int, config: TrafficConfig, seed: int, now: float) -> Node:
    """A mote that starts now; what it draws is keyed by the seed and its id."""
    draw = random.Random(f'{seed} node {node_id}')
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
