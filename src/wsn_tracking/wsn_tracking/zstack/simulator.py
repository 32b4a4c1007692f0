"""A sink with its network behind it: the device, what the motes say, and what goes wrong, as bytes at given times.

Nothing here waits or touches a port: `hear` takes the host's bytes, `poll` gives what is to be done by now, `due` says
when to ask again. Times are in s on a steady clock.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Sequence
from enum import Enum
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.agenda import Agenda
from wsn_tracking.zstack.device import DEFAULT_NETWORK, Device
from wsn_tracking.zstack.faults import Event, Happening, parse_faults
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.firmware.flavour import FLAVOURS
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.motes import Message
from wsn_tracking.zstack.on_board import Judge, in_radius
from wsn_tracking.zstack.payload import DOWN, Payload, decode_payload
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.records import FeedbackRecord, SensingRecord
from wsn_tracking.zstack.simulator_settings import SimulatorConfig
from wsn_tracking.zstack.traffic import Traffic
from wsn_tracking.zstack.uplink import check_carries, uplink_of
from wsn_tracking.zstack.wire import Wire

ROBOT_ADDRESS, ROBOTS = 0xF100, 256  # network addresses of the robots
ROBOT_IEEE = 0x00124B0014F00000
MAX_TOLD = 1000  # messages from the host that are kept
QUIET_S = 0.03  # of the line, after which faults give out what they hold back


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
Witness = Callable[[Message, bool], None]  # a message that the radio received, and whether the host is given it
Measure = Callable[[AirEpoch, float], AirEpoch]  # a request as it is said, and when: what the nodes measure of it


class Simulator:
    """The sink and everything behind it; `witness` is told of every message at the moment it is said.

    `measure` may read what the nodes measure off a world that the host has a hand in.
    """

    def __init__(
        self, config: SimulatorConfig, epochs: Sequence[AirEpoch], now: float = 0.0, on_board: Judge = in_radius
    ) -> None:
        """The sink is plugged in at `now`; `on_board`: the trigger of nodes that have one."""
        check_carries(config.sink_protocol, config.traffic.payload, epochs)
        self._config = config
        self._epochs = list(epochs)
        self.faults = parse_faults(config.faults, config.fault_time, config.seed)
        self.device = self._device(now)
        self.traffic = Traffic(config.traffic, config.radio, SCALES[config.lqi_scale], config.seed, on_board)
        self.witness: Witness = lambda message, given: None
        self.measure: Measure = lambda epoch, now: epoch
        self.told: deque[Told] = deque(maxlen=MAX_TOLD)
        self.counters: Counter[str] = Counter()
        self.sent: list[float] = []  # when each epoch was sent, so far
        self._uplink = uplink_of(config.sink_protocol, self.device, config.radio)
        self._agenda: Agenda[Callable[[], None]] = Agenda()
        self._wire = Wire(self.faults, config.baud, self._agenda.at, self._put)
        self._actions: list[Action] = []
        self._now = self._muted_until = now
        self._plugged = True
        self._appear()

    def begin(self, now: float) -> None:
        """The world begins."""
        self._advance(now)
        for epoch in self._epochs:
            self.traffic.join(self.traffic.speakers(epoch), now)
        self._announce()
        if self._epochs:
            self._agenda.at(now, lambda: self._epoch(0, now))

    def go_on(self, epochs: Sequence[AirEpoch], now: float) -> None:
        """More epochs, from `now` on, behind those that were sent; TrackingError where some are still to come."""
        self._advance(now)
        if self.to_come:
            raise TrackingError(f'epochs still to come: {self.to_come}; wait for them')
        first, lasted = len(self._epochs), self._after(epochs[0].time_s)
        self._epochs += epochs
        self._agenda.at(now, lambda: self._epoch(first, now - lasted))

    def happen(self, happening: Happening, now: float) -> None:
        """A fault that strikes now."""
        self._advance(now)
        self._happen(happening)

    def hear(self, data: bytes, now: float) -> None:
        """What the host says."""
        self._advance(now)
        self.counters['bytes_heard'] += len(data)
        if not self._speaks or self._config.sink_protocol == 'ascii':
            return
        for request in self.device.reader.feed(data):
            self.counters['requests'] += 1
            if any(fault.refuses(request) for fault in self.faults):
                self._say(self.device.refuse(request))
            else:
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
        return self._now if self._actions else min(self._agenda.due, self.device.due)

    @property
    def delivers(self) -> bool:
        """Whether messages reach the host."""
        return self._config.sink_protocol != 'znp' or self.device.delivers(self._config.radio)

    @property
    def finished(self) -> bool:
        """Whether everything was sent."""
        return not self.to_come and self._agenda.due == float('inf') and not self._actions

    @property
    def to_come(self) -> int:
        """Epochs that were not sent yet."""
        return len(self._epochs) - len(self.sent)

    # ---- within

    def _device(self, now: float) -> Device:
        config, tick = self._config, 0
        for fault in self.faults:
            tick = fault.first_tick(tick)
        return Device(
            FLAVOURS[config.flavour],
            network=DEFAULT_NETWORK if config.formed else None,
            up=config.up,
            seed=config.seed,
            first_tick=tick,
            now=now,
        )

    @property
    def _speaks(self) -> bool:
        return self._plugged and self._now >= self._muted_until

    def _advance(self, now: float) -> None:
        """Everything up to now, in order."""
        while (due := min(self._agenda.due, self.device.due)) <= now:
            self._now = max(self._now, due)
            if self.device.due <= due:
                self._say(self.device.advance(self._now))
            else:
                self._agenda.take()[1]()
        self._now = max(self._now, now)

    # ---- the world

    def _epoch(self, index: int, start: float) -> None:
        """What happens to sink and nodes, then what the nodes say."""
        now = self._now
        epoch = self.measure(self._epochs[index], now)
        self.sent.append(now)
        for happening in filter(None, (fault.happens(index) for fault in self.faults)):
            self._happen(happening)
        robot = ROBOT_ADDRESS + epoch.robot_id % ROBOTS
        self.device.chip.motes[robot] = Mote(robot, ROBOT_IEEE + epoch.robot_id)
        for fault in self.faults:
            self._say(fault.nodes(self.traffic.nodes, index, now))
        self._announce()
        messages = self.traffic.messages(epoch, now)
        for fault in self.faults:
            messages = fault.air(messages)
        is_last = index + 1 == len(self._epochs)
        if is_last:
            messages += [message for fault in self.faults for message in fault.held()]
        for message in messages:
            self._agenda.at(message.time_s, lambda message=message: self._receive(message))  # type: ignore[misc]
        if not is_last:
            after = self._after(self._epochs[index + 1].time_s)
            self._agenda.at(max(start + after, now), lambda: self._epoch(index + 1, start))

    def _after(self, time_s: float) -> float:
        """How long after the first epoch."""
        rate = self._config.rate
        return (time_s - self._epochs[0].time_s) / rate if rate else 0.0

    def _announce(self) -> None:
        self.device.chip.motes.update({node.short: node.mote for node in self.traffic.nodes.values()})

    def _receive(self, message: Message) -> None:
        """The sink's radio has received a message."""
        if not self._speaks:
            self.counters['messages_in_outage'] += 1
            self.witness(message, False)
            return
        self.counters['messages'] += 1
        said = self._uplink(message, self._now)
        self.witness(message, bool(said))
        for data in said:
            self._write(data)

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
            self._wire.clear()
            self._actions.append(Plug.OUT)
            self._agenda.at(end, self._plug_in)

    def _plug_in(self) -> None:
        self.device.power_cycle(self._now)
        self._plugged = True
        self._appear()

    def _appear(self) -> None:
        self._actions.append(Plug.IN)
        self._put(b''.join(fault.at_plug() for fault in self.faults))

    # ---- what the sink says

    def _reply(self, request: Frame, replies: Sequence[Frame]) -> None:
        later = [(0.0, reply) for reply in replies]
        for fault in self.faults:
            delay = max((seconds for seconds, _ in later), default=0.0)
            later = [(delay + more, reply) for more, reply in fault.reply(request, [reply for _, reply in later])]
        for seconds, reply in later:
            if seconds:
                self._agenda.at(self._now + seconds, lambda reply=reply: self._say([reply]))  # type: ignore[misc]
            else:
                self._say([reply])

    def _say(self, frames: Sequence[Frame]) -> None:
        for frame in frames:
            self._write(encode_frame(frame))

    def _write(self, data: bytes) -> None:
        if self._speaks:
            self._wire.write(data, self._now)
            if self.faults:
                self._agenda.at(self._now + QUIET_S, lambda: self._wire.flush(self._now))

    def _put(self, data: bytes) -> None:
        if data and self._speaks:
            self.counters['bytes_said'] += len(data)
            self._actions.append(data)

    # ---- what the host says to the nodes

    def _listen(self) -> None:
        sent = self.device.chip.sent
        while sent:
            message = sent.popleft()
            payload = decode_payload(message.data)
            ours = message.cluster == self._config.cluster and isinstance(payload, Payload) and payload.type in DOWN
            if not ours or not isinstance(payload, Payload):
                self.counters['not_understood'] += 1
                continue
            for record in payload.records:
                if isinstance(record, SensingRecord):
                    self.counters['sensing_command'] += 1
                    self.traffic.command(record)
                    self.told.append(Told(message.time_s, message.dst, record))
                elif isinstance(record, FeedbackRecord):
                    self.counters['feedback'] += 1
                    self.told.append(Told(message.time_s, message.dst, record))
