"""A host that talks to a simulated device without a line between them, and worlds behind it."""

import pytest
from zstack_cases import line_bytes, parse

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.device import Device
from wsn_tracking.zstack.firmware.chip import Mote
from wsn_tracking.zstack.firmware.flavour import FLAVOURS
from wsn_tracking.zstack.frames import Frame, Kind, encode_frame
from wsn_tracking.zstack.motes import TrafficConfig
from wsn_tracking.zstack.on_board import in_radius
from wsn_tracking.zstack.protocols import Radio, protocol_of
from wsn_tracking.zstack.readings import AirEpoch, Reading
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.simulator import Simulator
from wsn_tracking.zstack.simulator_settings import SimulatorConfig

RADIO = Radio()
REGISTER = c.AfRegister(0xE8, 0xBF01, in_clusters=(0x10,))
QUIET = TrafficConfig(heartbeat=0.0)
BOTH = pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
MOTE = Mote(0x143E, 0x00124B0014000003)


def device(flavour='home_1_2', **more):
    return Device(FLAVOURS[flavour], **more)


def understood(data):
    """Commands in what a sink said; what our side knows no command for stays a frame."""
    items = [(c.decode(frame), frame) for frame in parse(data)]
    return [frame if isinstance(command, Bad) else command for command, frame in items]


def asked(sink, question, now=0.0):
    """All that the sink says at once."""
    return understood(sink.feed(question if isinstance(question, bytes) else line_bytes(question), now))


def data_of(sink, header, data='', now=0.0):
    """The data of the one answer to a request that our side has no command for."""
    said = parse(sink.feed(encode_frame(frame(header, data)), now))
    (answer,) = [each for each in said if each.kind == Kind.SRSP]
    assert answer.header == header + 0x4000, answer
    return answer.data


def frame(header, data=''):
    return Frame(header, bytes.fromhex(data))


def by_and_by(sink, now):
    """All that it says by then."""
    return understood(b''.join(line_bytes(f) for f in sink.advance(now)))


def attached(sink, now=0.0):
    """As a host leaves it that wants our messages."""
    asked(sink, c.ZdoStartup(100), now)
    by_and_by(sink, now + 1.0)
    assert asked(sink, REGISTER, now + 1.0) == [c.AfRegisterRsp(0)]
    return sink


def joined(flavour='home_1_2'):
    """An attached sink with a mote in its network."""
    sink = attached(device(flavour))
    sink.chip.motes[MOTE.short] = MOTE
    return sink


def epochs(count=5, nodes=4, period=1.0, robot=1, **more):
    """Node k hears -40 - k - 0.3 dBm."""
    return [
        AirEpoch(k * period, robot, k, tuple(Reading(n, rssi_dbm=-40.3 - n, **more) for n in range(1, nodes + 1)))
        for k in range(count)
    ]


class Host:
    """Attaches to a simulator and takes what it says, in simulated time."""

    def __init__(self, world=None, step=0.01, on_board=in_radius, **config):
        self.config = SimulatorConfig(**{'traffic': QUIET, **config})
        self.world = epochs() if world is None else world
        self.now = 1000.0
        self.simulator = Simulator(self.config, self.world, self.now, on_board)
        self.protocol = protocol_of(self.config.sink_protocol, self.config.radio)
        self.items, self.times, self.actions = [], [], []
        self._step = step

    def say(self, *commands):
        for command in commands:
            self.simulator.hear(command if isinstance(command, bytes) else line_bytes(command), self.now)
        self.until(self.now)

    def attach(self):
        if self.config.sink_protocol == 'znp':
            self.say(c.ZdoStartup(100))
            self.until(self.now + 0.3)
            self.say(REGISTER)

    def until(self, end):
        while True:
            for action in self.simulator.poll(self.now):
                self.actions.append((self.now, action))
                if isinstance(action, bytes):
                    items = self.protocol.feed(action, self.now)
                    self.items += items
                    self.times += [self.now] * len(items)
                else:
                    self.items.append(action)
                    self.times.append(self.now)
            if self.now >= end:
                return self
            self.now = min(max(self.simulator.due, self.now + 1e-6), self.now + self._step, end)

    def run(self, limit=60.0):
        """The whole world."""
        self.attach()
        self.simulator.begin(self.now)
        end = self.now + limit
        while not self.simulator.finished:
            assert self.now < end
            self.until(self.now + self._step)
        self.items += self.protocol.flush()
        return self

    @property
    def reports(self):
        return [item for item in self.items if isinstance(item, Report)]

    def of(self, kind):
        return [item for item in self.items if isinstance(item, kind)]

    def bad(self):
        return sorted(item.reason for item in self.items if isinstance(item, Bad))

    def heard(self):
        """(node, beacon, rssi) of every record that came."""
        return sorted(
            (report.payload.node_id, record.beacon_seq, record.rssi_dbm)
            for report in self.reports
            for record in report.payload.records
        )


def expected(world):
    """What `heard` is where nothing is lost."""
    return sorted((r.node_id, epoch.request_seq % 256, round(r.rssi_dbm)) for epoch in world for r in epoch.readings)
