"""What a sink is, from what it said: the answers to `sink probe`, or whatever a file of captured bytes holds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.commands import (
    COORDINATOR_UP,
    AfIncomingMsg,
    SysPingRsp,
    SysVersionRsp,
    UtilGetDeviceInfoRsp,
    ZdoExtNwkInfoRsp,
    decode,
)
from wsn_tracking.zstack.describe import TYPES, describe_command
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.lqi import scale_words
from wsn_tracking.zstack.payload import PayloadType
from wsn_tracking.zstack.protocols import Item
from wsn_tracking.zstack.reports import Report

STATES = {0: 'not started', 8: 'starting', COORDINATOR_UP: 'coordinator, network up'}


class Survey:
    """Collects what is said; `add` can be the tap of a protocol."""

    def __init__(self) -> None:
        self._ping: SysPingRsp | None = None
        self._version: SysVersionRsp | None = None
        self._device: UtilGetDeviceInfoRsp | None = None
        self._network: ZdoExtNwkInfoRsp | None = None
        self._lqis: list[int] = []
        self._reports: Counter[int] = Counter()
        self._nodes: set[int] = set()
        self._rejected: Counter[str] = Counter()

    def add(self, raw: Frame | bytes, item: Item) -> None:
        """One frame or line, and what it is."""
        said = decode(raw) if isinstance(raw, Frame) else None
        if isinstance(said, SysPingRsp):
            self._ping = said
        elif isinstance(said, SysVersionRsp):
            self._version = said
        elif isinstance(said, UtilGetDeviceInfoRsp):
            self._device = said
        elif isinstance(said, ZdoExtNwkInfoRsp):
            self._network = said
        elif isinstance(said, AfIncomingMsg):
            self._lqis.append(said.lqi)  # those of neighbour tables are of no scale: stacks smooth them
        if isinstance(item, Report):
            self._reports[item.payload.type] += 1
            self._nodes.add(item.payload.node_id)
        elif isinstance(item, Bad):
            self._rejected[item.reason] += 1

    def lines(self, lqi_scale: str) -> Iterator[str]:
        """The findings, one a line."""
        firmware = 'not told' if self._version is None else str(self._version)
        yield f'firmware  {firmware}'
        if self._ping is not None:
            yield f'offers    {describe_command(self._ping)}'
        if self._device is not None:
            device = self._device
            state = f'state {device.state} ({STATES.get(device.state, "not a coordinator that is up")})'
            yield f'device    {device.ieee:#018x}, address {device.short:#06x}, {state}'
        if self._network is not None:
            info = self._network
            yield f'network   channel {info.channel}, PAN {info.pan_id:#06x}, extended PAN {info.ext_pan:#018x}'
        yield f'reports   {self._told() or "none"}'
        yield f'LQI       {scale_words(self._lqis, lqi_scale)}'
        if self._rejected:
            yield 'rejected  ' + ', '.join(f'{reason} {n}' for reason, n in sorted(self._rejected.items()))

    def _told(self) -> str:
        if not self._reports:
            return ''
        kinds = ', '.join(f'{n} x {TYPES[PayloadType(kind)]}' for kind, n in sorted(self._reports.items()))
        return f'{kinds}, of nodes {" ".join(map(str, sorted(self._nodes)))}'
