"""AF: registration of our endpoint, data from and to the nodes; and the reports of a sink that speaks MT_APP."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.commands.table import command
from wsn_tracking.zstack.layout import Shape

ALREADY_REGISTERED = (0x02, 0xB8)  # statuses of AF_REGISTER that mean: has been done before


@command(0x2400, 'AF_REGISTER', 'BHHBB*H*H')
class AfRegister(NamedTuple):
    """Have messages to this endpoint passed to the host; lives in the sink's RAM."""

    endpoint: int
    profile: int
    device: int = 0
    version: int = 0
    latency: int = 0
    in_clusters: tuple[int, ...] = ()
    out_clusters: tuple[int, ...] = ()


@command(0x6400, 'AF_REGISTER', 'B')
class AfRegisterRsp(NamedTuple):
    """Was it registered."""

    status: int


@command(0x4481, 'AF_INCOMING_MSG', 'HHHBBBBBIB*B?HB')
class AfIncomingMsg(NamedTuple):
    """A message of a node; the last two fields are absent on old stacks."""

    group: int
    cluster: int
    src: int  # network address of the node
    src_endpoint: int
    dst_endpoint: int
    was_broadcast: int
    lqi: int  # of the LAST hop into the sink
    security: int
    timestamp: int  # sink clock [ticks]
    trans_seq: int  # always 0
    data: bytes
    mac_src: int | None = None  # who transmitted the last hop
    radius: int | None = None  # hops that were left


@command(0x2401, 'AF_DATA_REQUEST', 'HBBHBBB*B')
class AfDataRequest(NamedTuple):
    """Send data to a node."""

    dst: int
    dst_endpoint: int
    src_endpoint: int
    cluster: int
    trans_id: int
    options: int
    radius: int
    data: bytes


@command(0x6401, 'AF_DATA_REQUEST', 'B')
class AfDataRequestRsp(NamedTuple):
    """Was it accepted for sending."""

    status: int


@command(0x4480, 'AF_DATA_CONFIRM', 'BBB')
class AfDataConfirm(NamedTuple):
    """How the sending of `trans_id` went."""

    status: int
    endpoint: int
    trans_id: int


# an endpoint, then whatever its application says: of ours, a header that counts records of 8 bytes, and a CRC
PAYLOAD = Shape(1, 250, at=11, unit=8, tails=(3,), may_differ=True)


@command(0x6980, 'MT_APP_RSP', 'B$', shape=PAYLOAD)
class MtAppRsp(NamedTuple):
    """A report as a SampleApp coordinator passes it on (MTProcessAppRspMsg)."""

    endpoint: int
    data: bytes
