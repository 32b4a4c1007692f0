"""A sink with its network behind it: the device, what the motes say, and what goes wrong, as bytes at given times.

Nothing here waits or touches a port: `hear` takes the host's bytes, `poll` gives what is to be done by now, `due` says
when to ask again. Times are in s on a steady clock.
"""

from __future__ import annotations

import heapq
import itertools
from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.parameters import group, param
from wsn_tracking.zstack.commands import AfIncomingMsg, MtAppRsp, encode
from wsn_tracking.zstack.device import DEFAULT_NETWORK, Device
from wsn_tracking.zstack.faults import Event, Happening, Write, parse_faults
from wsn_tracking.zstack.firmware.chip import Mote, Sent
from wsn_tracking.zstack.firmware.flavour import FLAVOURS
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.payload import DOWN, Payload, decode_payload
from wsn_tracking.zstack.protocols import PROTOCOLS, Radio
from wsn_tracking.zstack.records import FeedbackRecord, RssiRecord, SensingRecord
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.traffic import AirEpoch, Message, Traffic, TrafficConfig

ROBOT_ADDRESS = 0xF100  # robots hear what the host sends; theirs follow from here
MAX_HEARD = 1000  # messages from the host that are kept
QUIET_S = 0.03  # of the line, after which faults give out what they hold back
BITS = 10  # of the line a byte


@dataclass(frozen=True)
class SimulatorConfig:
    """A simulated sink."""

    link: str = param('wsn_sink', 'symbolic link to the port of the sink; made anew at every plug')
    sink_protocol: str = param('znp', 'what the firmware speaks', choices=PROTOCOLS)
    flavour: str = param('home_1_2', 'the firmware', choices=tuple(FLAVOURS))
    formed: bool = param(True, 'the sink remembers a network')
    up: bool = param(False, 'its network is up already, as after a restart of the host')
    endpoint: int = param(0xE8, 'endpoint of the messages', '', low=1, high=240)
    profile: int = param(0xBF01, 'profile of the messages', '', low=0, high=0xFFFF)
    cluster: int = param(0x0010, 'cluster of the messages', '', low=0, high=0xFFFF)
    default_radius: int = param(30, 'radius with which nodes send', 'hops', low=1, high=255)
    lqi_scale: str = param('cc2530', 'how the radio of the sink computes LQI', choices=tuple(SCALES))
    baud: int = param(0, 'speed of the line; 0: as fast as the host reads', 'Bd', low=0, high=4e6)
    rate: float = param(1.0, 'speed, as a multiple of real time; 0: all at once', '', low=0.0, high=1e6)
    faults: tuple[str, ...] = param(('',), 'what goes wrong: name or name=value, see the docs')
    fault_time: float = param(4.0, 'how long outages last, and how late late answers are', 's', low=0.0, high=3600.0)
    seed: int = param(0, 'of the radio noise, the nodes and the faults', '', low=0)
    traffic: TrafficConfig = group(TrafficConfig)

    @property
    def radio(self) -> Radio:
        """What the messages bear."""
        return Radio(self.endpoint, self.profile, self.cluster, self.default_radius)


class Plug(Enum):
    """What happens to the port."""

    IN = 'in'
    OUT = 'out'


class Told(NamedTuple):
    """What the host has told the nodes: position feedback, or a sensing command."""

    time_s: float
    dst: int
    record: FeedbackRecord | SensingRecord


Action = bytes | Plug
Job = Callable[[], None]


class Simulator:
    """The sink and everything behind it."""

    def __init__(self, config: SimulatorConfig, epochs: Sequence[AirEpoch]) -> None:
        self._check(config, epochs)
        self._config = config
        self._epochs = epochs
        self.faults = parse_faults(config.faults, config.fault_time, config.seed)
        tick = 0
        for fault in self.faults:
            tick = fault.first_tick(tick)
        network = DEFAULT_NETWORK if config.formed else None
        flavour = FLAVOURS[config.flavour]
        self.device = Device(flavour, network=network, up=config.up, seed=config.seed, first_tick=tick)
        self.traffic = Traffic(config.traffic, config.radio, SCALES[config.lqi_scale], config.seed)
        self.told: deque[Told] = deque(maxlen=MAX_HEARD)
        self.counters: Counter[str] = Counter()
        self.epoch = -1  # the last that has begun
        self._sent: list[float] = []  # when each epoch was sent
        self._jobs: list[tuple[float, int, Job]] = []
        self._numbers = itertools.count()
        self._actions: list[Action] = [Plug.IN]
        self._line_free = 0.0
        self._messages = 0  # underway
        self._muted_until = 0.0
        self._plugged = True
        self._now = 0.0
        self._put(b''.join(fault.at_plug() for fault in self.faults))

    @staticmethod
    def _check(config: SimulatorConfig, epochs: Sequence[AirEpoch]) -> None:
        if config.sink_protocol != 'ascii':
            return
        kinds = {config.traffic.payload}
        ranged = any(r.rssi_dbm is None for epoch in epochs[:1] for r in epoch.readings)
        if kinds & {'range', 'worn'} or ('auto' in kinds and ranged):
            raise TrackingError('sink_protocol ascii carries signal strengths of robots only: choose znp or mt_app')

    # ---- to be called

    def begin(self, now: float) -> None:
        """The world begins."""
        self._advance(now)
        self.traffic.join(sorted({i for epoch in self._epochs for i in self.traffic_ids(epoch)}), now)
        self._announce()
        if self._epochs:
            self._at(now, lambda: self._begin(0, now))

    def traffic_ids(self, epoch: AirEpoch) -> list[int]:
        """The motes that speak of an epoch."""
        return self.traffic.speakers(epoch)

    def hear(self, data: bytes, now: float) -> None:
        """What the host says."""
        self._advance(now)
        self.counters['bytes_heard'] += len(data)
        if not self._plugged or now < self._muted_until or self._config.sink_protocol == 'ascii':
            return
        for request in self.device.reader.feed(data):
            self.counters['requests'] += 1
            self._reply(request, self.device.answer(request, now))
        self._listen()

    def poll(self, now: float) -> list[Action]:
        """What is to be done by now, in order."""
        self._advance(now)
        actions, self._actions = self._actions, []
        return actions

    @property
    def due(self) -> float:
        """When `poll` will have something."""
        first = self._jobs[0][0] if self._jobs else float('inf')
        return min(first, self.device.due, self._now if self._actions else float('inf'))

    @property
    def delivers(self) -> bool:
        """Whether messages reach the host."""
        return self._config.sink_protocol != 'znp' or self.device.delivers(self._config.radio)

    @property
    def finished(self) -> bool:
        """Whether everything was sent."""
        return self.epoch + 1 >= len(self._epochs) and not self._messages and not self._actions

    @property
    def sent(self) -> Sequence[float]:
        """When each epoch was sent, so far."""
        return self._sent

    # ---- time

    def _at(self, time_s: float, job: Job) -> None:
        heapq.heappush(self._jobs, (time_s, next(self._numbers), job))

    def _advance(self, now: float) -> None:
        """Everything up to now, in order."""
        while True:
            first = self._jobs[0][0] if self._jobs else float('inf')
            if min(first, self.device.due) > now:
                break
            if self.device.due <= first:
                self._now = max(self._now, self.device.due)
                self._say(self.device.advance(self._now))
            else:
                due, _, job = heapq.heappop(self._jobs)
                self._now = max(self._now, due)
                job()
        self._now = max(self._now, now)

    # ---- the world

    def _begin(self, index: int, start: float) -> None:
        """An epoch: what happens to sink and nodes, then what the nodes say."""
        self.epoch = index
        self._sent.append(self._now)
        for happening in filter(None, (fault.happens(index) for fault in self.faults)):
            self._happen(happening)
        epoch, now = self._epochs[index], self._now
        self.traffic.join(self.traffic_ids(epoch), now)
        self.device.chip.motes[ROBOT_ADDRESS + epoch.robot_id % 256] = Mote(ROBOT_ADDRESS + epoch.robot_id % 256, 0)
        for fault in self.faults:
            self._say(fault.nodes(self.traffic.nodes, index, now))
        self._announce()
        messages = self.traffic.messages(epoch, now)
        for fault in self.faults:
            messages = fault.air(messages)
        for message in messages:
            self._messages += 1
            self._at(message.time_s, lambda message=message: self._receive(message))  # type: ignore[misc]
        if index + 1 < len(self._epochs):
            rate = self._config.rate
            after = (self._epochs[index + 1].time_s - self._epochs[0].time_s) / rate if rate else 0.0
            self._at(max(start + after, now), lambda: self._begin(index + 1, start))

    def _announce(self) -> None:
        self.device.chip.motes.update({node.short: node.mote for node in self.traffic.nodes.values()})

    def _receive(self, message: Message) -> None:
        """The sink's radio has received a message."""
        self._messages -= 1
        if not self._plugged or self._now < self._muted_until:
            self.counters['messages_in_outage'] += 1
            return
        self.counters['messages'] += 1
        if self._config.sink_protocol == 'ascii':
            for line in self._lines(message):
                self._strike(Write(line))
        else:
            self._say(self._frames(message))

    def _frames(self, message: Message) -> list[Frame]:
        radio, device = self._config.radio, self.device
        if self._config.sink_protocol == 'mt_app':
            return [encode(MtAppRsp(message.endpoint, message.bytes))] if message.cluster == radio.cluster else []
        if message.endpoint != radio.endpoint and radio.endpoint in device.chip.endpoints:
            mine = device.chip.endpoints[radio.endpoint]  # another application of the host listens there
            device.chip.endpoints.setdefault(message.endpoint, mine._replace(endpoint=message.endpoint))
        endpoint, was_broadcast = message.endpoint, int(message.was_broadcast)
        radius = max(radio.default_radius - message.hops, 0)
        incoming = AfIncomingMsg(
            0, message.cluster, message.src, endpoint, endpoint, was_broadcast, message.lqi, 0, 0, 0,
            message.bytes, message.mac_src, radius,
        )  # fmt: skip
        return device.incoming(incoming, self._now)

    def _lines(self, message: Message) -> list[bytes]:
        if message.cluster != self._config.cluster or message.endpoint != self._config.endpoint:
            return []
        payload = message.payload
        parts: list[Payload] = [payload._replace(records=(record,)) for record in payload.records] or [payload]
        lines = [encode_line(Report(part, lqi=message.lqi, hops=message.hops)) for part in parts]
        return lines if message.data is None else [line.replace(b'*', b'#') for line in lines]

    # ---- what happens to the sink

    def _happen(self, happening: Happening) -> None:
        self.counters[happening.event.value] += 1
        end = self._now + happening.seconds
        if happening.event is Event.RESET:
            self.device.reset(self._now)
            self._put(b''.join(fault.at_plug() for fault in self.faults))
        elif happening.event is Event.MUTE:
            self._muted_until = end
        else:
            self._plugged = False
            self._actions.append(Plug.OUT)
            self._at(end, self._plug_in)

    def _plug_in(self) -> None:
        self._plugged = True
        self._actions.append(Plug.IN)
        self.device.power_cycle(self._now)
        self._put(b''.join(fault.at_plug() for fault in self.faults))

    # ---- what the sink says

    def _reply(self, request: Frame, replies: Sequence[Frame]) -> None:
        later = [(0.0, reply) for reply in replies]
        for fault in self.faults:
            later = [
                (seconds + more, frame)
                for seconds, reply in (later or [(0.0, None)])
                for more, frame in fault.reply(request, () if reply is None else (reply,))
            ]
        for seconds, reply in later:
            if seconds:
                self._at(self._now + seconds, lambda reply=reply: self._say([reply]))  # type: ignore[misc]
            else:
                self._say([reply])

    def _say(self, frames: Sequence[Frame]) -> None:
        for frame in frames:
            self._strike(Write(encode_frame(frame)))

    def _strike(self, write: Write) -> None:
        """Bytes on their way to the line, past the faults of the line."""
        if not self._plugged or self._now < self._muted_until:
            return
        writes = [write]
        for fault in self.faults:
            writes = [struck for each in writes for struck in fault.line(each)]
        self._write(writes)
        self._at(self._now + QUIET_S, self._flush)

    def _flush(self) -> None:
        self._write([write for fault in self.faults for write in fault.flush()])

    def _write(self, writes: Sequence[Write]) -> None:
        """Onto the line, one after the other."""
        for data, pause in writes:
            begin = max(self._now, self._line_free)
            self._line_free = begin + pause + (len(data) * BITS / self._config.baud if self._config.baud else 0.0)
            if begin <= self._now:
                self._put(data)
            else:
                self._at(begin, lambda data=data: self._put(data))  # type: ignore[misc]

    def _put(self, data: bytes) -> None:
        if data and self._plugged and self._now >= self._muted_until:
            self.counters['bytes_said'] += len(data)
            self._actions.append(data)

    # ---- what the host says to the nodes

    def _listen(self) -> None:
        while self.device.chip.sent:
            sent: Sent = self.device.chip.sent.popleft()
            payload = decode_payload(sent.data)
            if sent.cluster != self._config.cluster or not isinstance(payload, Payload) or payload.type not in DOWN:
                self.counters['not_understood'] += 1
                continue
            for record in payload.records:
                if isinstance(record, SensingRecord):
                    self.traffic.command(record)
                if not isinstance(record, RssiRecord) and isinstance(record, (FeedbackRecord, SensingRecord)):
                    self.counters['feedback' if isinstance(record, FeedbackRecord) else 'sensing_command'] += 1
                    self.told.append(Told(sent.time_s, sent.dst, record))
