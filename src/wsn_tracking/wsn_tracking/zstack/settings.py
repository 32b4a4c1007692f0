"""What can be set of the link to a sink: parameters of the node and options of the command line."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.parameters import group, param
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.protocols import PROTOCOLS, Radio


@dataclass(frozen=True)
class TimeoutConfig:
    """How long to wait, and how often to try (zstack.md, sections 2 to 4)."""

    settle: float = param(0.1, 'after opening, before stale input is dropped', 's', low=0.0, high=60.0)
    gap: float = param(0.1, 'pause of the line that ends a frame', 's', low=0.001, high=10.0)
    ping: float = param(0.5, 'answer to a ping', 's', low=0.01, high=60.0)
    wake: float = param(1.0, 'after the bytes that make the sink leave its boot loader', 's', low=0.0, high=60.0)
    reply: float = param(3.0, 'answer to any other request', 's', low=0.01, high=60.0)
    tries: int = param(3, 'times to ask where asking again does no harm', '', low=1, high=100)
    startup: float = param(40.0, 'answer to starting the network', 's', low=0.01, high=600.0)
    reset: float = param(10.0, 'the sink to come back from a reset', 's', low=0.01, high=600.0)
    commissioning: float = param(60.0, 'the network to come up', 's', low=0.01, high=600.0)
    idle: float = param(5.0, 'silence after which the sink is pinged', 's', low=0.01, high=3600.0)
    misses: int = param(3, 'pings without an answer after which the sink is lost', '', low=1, high=100)
    confirm: float = param(5.0, 'confirmation of a message to a node', 's', low=0.01, high=600.0)
    send_age: float = param(2.0, 'a message to a node that has waited longer for the link is dropped', 's', low=0.01)
    reopen_first: float = param(0.5, 'before the port is opened again; doubles', 's', low=0.001, high=60.0)
    reopen_last: float = param(5.0, 'longest time before the port is opened again', 's', low=0.001, high=600.0)


@dataclass(frozen=True)
class FormConfig:
    """Forming a new network, which erases the one the sink remembers: only with the confirmation."""

    confirm: str = param(
        '', 'IEEE address of the sink (`sink probe` shows it) whose network may be erased; empty: none'
    )
    channel: int = param(11, 'radio channel of the new network', '', low=11, high=26)
    pan_id: int = param(0x1A62, 'id of the new network', '', low=0, high=0xFFFE)


@dataclass(frozen=True)
class LinkConfig:
    """The serial line, the sink behind it, and what our messages bear."""

    port: str = param('/dev/ttyACM0', 'serial port; /dev/serial/by-id/... stays the same after a replug')
    sink_protocol: str = param('znp', 'what the firmware of the sink speaks', choices=PROTOCOLS)
    baud: int = param(115200, 'speed of a UART; SampleApp builds: 38400; a CC2531 ignores it', 'Bd', low=1200, high=4e6)
    rtscts: bool = param(False, 'hardware flow control, as the firmware has it')
    toggle_dtr_rts: bool = param(False, 'reset a silent sink by the lines DTR and RTS, where they are wired so')
    endpoint: int = param(0xE8, 'endpoint of our messages', '', low=1, high=240)
    profile: int = param(0xBF01, 'profile of our messages', '', low=0, high=0xFFFF)
    cluster: int = param(0x0010, 'cluster of our messages', '', low=0, high=0xFFFF)
    default_radius: int = param(30, 'radius with which nodes send, for the number of hops', 'hops', low=1, high=255)
    multicast_group: int = param(0, 'multicast group to be heard; 0: none', '', low=0, high=0xFFFF)
    lqi_scale: str = param('cc2530', 'how the radio of the sink computes LQI', choices=tuple(SCALES))
    host_queue: int = param(
        10_000, 'reports that wait for the host; beyond, the oldest is dropped', '', low=1, high=1e7
    )
    send_queue: int = param(100, 'messages to nodes that wait; beyond, the oldest is dropped', '', low=1, high=1e6)
    timeout: TimeoutConfig = group(TimeoutConfig)
    form: FormConfig = group(FormConfig)

    @property
    def radio(self) -> Radio:
        """What tells our messages from those of others."""
        return Radio(self.endpoint, self.profile, self.cluster, self.default_radius)
