"""ZDO: the state of the network, and who is in it."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.commands.table import command
from wsn_tracking.zstack.layout import Shape

COORDINATOR_UP = 9  # device state
NEIGHBOUR_TYPES = ('coordinator', 'router', 'end device', 'unknown')


@command(0x2540, 'ZDO_STARTUP_FROM_APP', 'H', shape=Shape(1, 2))  # some hosts give a delay of a byte
class ZdoStartup(NamedTuple):
    """Start the network, or take up the one the sink remembers."""

    delay: int = 100


@command(0x6540, 'ZDO_STARTUP_FROM_APP', 'B')
class ZdoStartupRsp(NamedTuple):
    """Status 0: network restored, 1: new network (no error), 2: failed."""

    status: int


@command(0x45C0, 'ZDO_STATE_CHANGE_IND', 'B')
class ZdoStateChangeInd(NamedTuple):
    """The sink's device state has changed."""

    state: int


@command(0x2550, 'ZDO_EXT_NWK_INFO')
class ZdoExtNwkInfo(NamedTuple):
    """Which network is it."""


@command(0x6550, 'ZDO_EXT_NWK_INFO', 'HBHHQQB')
class ZdoExtNwkInfoRsp(NamedTuple):
    """24 bytes; TI's PDF omits the device state."""

    short: int
    state: int
    pan_id: int
    parent: int
    ext_pan: int
    parent_ieee: int
    channel: int


@command(0x254B, 'ZDO_EXT_ADD_GROUP', 'BH*B')
class ZdoExtAddGroup(NamedTuple):
    """Have messages to a multicast group passed to the endpoint."""

    endpoint: int
    group: int
    name: bytes = b''


@command(0x654B, 'ZDO_EXT_ADD_GROUP', 'B')
class ZdoExtAddGroupRsp(NamedTuple):
    """Was it added."""

    status: int


class Neighbour(NamedTuple):
    """A radio that the asked one hears."""

    ext_pan: int
    ieee: int
    short: int
    bits: int
    permit_join: int
    depth: int
    lqi: int

    @property
    def device_type(self) -> str:
        """In words."""
        return NEIGHBOUR_TYPES[self.bits & 3]


@command(0x2531, 'ZDO_MGMT_LQI_REQ', 'HB')
class ZdoMgmtLqiReq(NamedTuple):
    """Ask a radio for its neighbours, from the `start`-th on."""

    dst: int
    start: int = 0


@command(0x6531, 'ZDO_MGMT_LQI_REQ', 'B')
class ZdoMgmtLqiReqRsp(NamedTuple):
    """Was the question sent."""

    status: int


@command(0x45B1, 'ZDO_MGMT_LQI_RSP', 'HB?BB*(QQHBBBB)', Neighbour)
class ZdoMgmtLqiRsp(NamedTuple):
    """A part of the neighbours; an error may be the first two fields alone."""

    src: int
    status: int
    total: int | None = None
    start: int | None = None
    neighbours: tuple[Neighbour, ...] = ()


@command(0x45C1, 'ZDO_END_DEVICE_ANNCE_IND', 'HHQB')
class ZdoEndDeviceAnnceInd(NamedTuple):
    """A node has joined, or come back under another address."""

    src: int
    short: int
    ieee: int
    capability: int


@command(0x45C4, 'ZDO_SRC_RTG_IND', 'H*H')
class ZdoSrcRtgInd(NamedTuple):
    """The route to a node."""

    dst: int
    relays: tuple[int, ...] = ()


@command(0x45C9, 'ZDO_LEAVE_IND', 'HQBBB')
class ZdoLeaveInd(NamedTuple):
    """A node has left."""

    src: int
    ieee: int
    request: int
    remove: int
    rejoin: int


@command(0x45CA, 'ZDO_TC_DEV_IND', 'HQH')
class ZdoTcDevInd(NamedTuple):
    """The trust centre has seen a node join at `parent`."""

    src: int
    ieee: int
    parent: int
