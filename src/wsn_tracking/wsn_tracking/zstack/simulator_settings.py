"""What can be set of a simulated sink: parameters of the node and options of the command line."""

from __future__ import annotations

from dataclasses import dataclass

from wsn_tracking.parameters import group, param
from wsn_tracking.zstack.firmware.flavour import FLAVOURS
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.motes import TrafficConfig
from wsn_tracking.zstack.protocols import PROTOCOLS, Radio


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
    faults: tuple[str, ...] = param(('',), 'what goes wrong: name or name=value; the docs list them')
    fault_time: float = param(4.0, 'how long outages last, and how late late answers are', 's', low=0.0, high=3600.0)
    seed: int = param(0, 'of the radio noise, the nodes and the faults', '', low=0)
    traffic: TrafficConfig = group(TrafficConfig)

    @property
    def radio(self) -> Radio:
        """What the messages bear."""
        return Radio(self.endpoint, self.profile, self.cluster, self.default_radius)
