"""A sink with its network behind it: the device, what the motes say, and what goes wrong, as bytes at given times.

Nothing here waits or touches a port: `hear` takes the host's bytes, `poll` gives what is to be done by now, `due` says
when to ask again. Times are in s on a steady clock.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Sequence

from wsn_tracking.zstack.agenda import Agenda
from wsn_tracking.zstack.course import Course
from wsn_tracking.zstack.device import DEFAULT_NETWORK, Device
from wsn_tracking.zstack.downlink import Downlink, Told
from wsn_tracking.zstack.faults import Event, Happening, parse_faults, struck_replies
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.firmware.flavour import FLAVOURS
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.motes import Message
from wsn_tracking.zstack.on_board import Judge, in_radius
from wsn_tracking.zstack.outlet import Action, Outlet
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.simulator_settings import SimulatorConfig
from wsn_tracking.zstack.traffic import Traffic
from wsn_tracking.zstack.uplink import check_carries, uplink_of

ROBOT_ADDRESS, ROBOTS = 0xF100, 256  # network addresses of the robots
ROBOT_IEEE = 0x00124B0014F00000


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
        self._course = Course(epochs, config.rate)
        self.faults = parse_faults(config.faults, config.fault_time, config.seed)
        self.device = self._device(now)
        self.traffic = Traffic(config.traffic, config.radio, SCALES[config.lqi_scale], config.seed, on_board)
        self.witness: Witness = lambda message, given: None
        self.measure: Measure = lambda epoch, now: epoch
        self.counters: Counter[str] = Counter()
        self._uplink = uplink_of(config.sink_protocol, self.device, config.radio)
        self._agenda: Agenda[Callable[[], None]] = Agenda()
        self._now = now
        self._outlet = Outlet(self.faults, config.baud, self._agenda, lambda: self._now, self.counters)
        self._downlink = Downlink(config.cluster, self.traffic, self.counters)
        self._outlet.plug_in()

    def begin(self, now: float) -> None:
        """The world begins."""
        self._advance(now)
        for epoch in self._course.epochs:
            self.traffic.join(self.traffic.speakers(epoch), now)
        self._announce()
        if self._course.epochs:
            self._agenda.at(now, lambda: self._epoch(0, now))

    def go_on(self, epochs: Sequence[AirEpoch], now: float) -> None:
        """More epochs, from `now` on, behind those that were sent; TrackingError where some are still to come."""
        self._advance(now)
        first = self._course.extend(epochs)
        start = now - self._course.after(first)
        self._agenda.at(now, lambda: self._epoch(first, start))

    def happen(self, happening: Happening, now: float) -> None:
        """A fault that strikes now."""
        self._advance(now)
        self._happen(happening)

    def hear(self, data: bytes, now: float) -> None:
        """What the host says."""
        self._advance(now)
        self.counters['bytes_heard'] += len(data)
        if not self._outlet.is_open or self._config.sink_protocol == 'ascii':
            return
        for request in self.device.reader.feed(data):
            self.counters['requests'] += 1
            if any(fault.refuses(request) for fault in self.faults):
                self._say(self.device.refuse(request))
            else:
                self._reply(request, self.device.answer(request, now))
        self._downlink.take(self.device.chip.sent)

    def poll(self, now: float) -> list[Action]:
        """What is to be done by now, in order."""
        self._advance(now)
        return self._outlet.take()

    @property
    def due(self) -> float:
        """When `poll` will have something."""
        return self._now if self._outlet.waits else min(self._agenda.due, self.device.due)

    @property
    def delivers(self) -> bool:
        """Whether messages reach the host."""
        return self._config.sink_protocol != 'znp' or self.device.delivers(self._config.radio)

    @property
    def finished(self) -> bool:
        """Whether everything was sent."""
        return not self.to_come and self._agenda.due == float('inf') and not self._outlet.waits

    @property
    def to_come(self) -> int:
        """Epochs that were not sent yet."""
        return self._course.to_come

    @property
    def sent(self) -> list[float]:
        """When each epoch was sent, so far."""
        return self._course.sent

    @property
    def told(self) -> deque[Told]:
        """What the host has told the nodes."""
        return self._downlink.told

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
        epoch = self.measure(self._course.epochs[index], now)
        self._course.sent.append(now)
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
        if not self._course.to_come:
            messages += [message for fault in self.faults for message in fault.held()]
        for message in messages:
            self._agenda.at(message.time_s, lambda message=message: self._receive(message))  # type: ignore[misc]
        if self._course.to_come:
            due = start + self._course.after(index + 1)
            self._agenda.at(max(due, now), lambda: self._epoch(index + 1, start))

    def _announce(self) -> None:
        self.device.chip.motes.update({node.short: node.mote for node in self.traffic.nodes.values()})

    def _receive(self, message: Message) -> None:
        """The sink's radio has received a message."""
        if not self._outlet.is_open:
            self.counters['messages_in_outage'] += 1
            self.witness(message, False)
            return
        self.counters['messages'] += 1
        said = self._uplink(message, self._now)
        self.witness(message, bool(said))
        for data in said:
            self._outlet.write(data)

    # ---- what happens to the sink

    def _happen(self, happening: Happening) -> None:
        self.counters[happening.event.value] += 1
        end = self._now + happening.seconds
        if happening.event is Event.RESET:
            self.device.reset(self._now)
            self._outlet.put_first()
        elif happening.event is Event.MUTE:
            self._outlet.mute(end)
        else:
            self._outlet.pull()
            self._agenda.at(end, self._plug_in)

    def _plug_in(self) -> None:
        self.device.power_cycle(self._now)
        self._outlet.plug_in()

    # ---- what the sink says

    def _reply(self, request: Frame, replies: Sequence[Frame]) -> None:
        for seconds, reply in struck_replies(self.faults, request, replies):
            if seconds:
                self._agenda.at(self._now + seconds, lambda reply=reply: self._say([reply]))  # type: ignore[misc]
            else:
                self._say([reply])

    def _say(self, frames: Sequence[Frame]) -> None:
        for frame in frames:
            self._outlet.write(encode_frame(frame))
