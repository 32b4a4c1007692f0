"""SYS: reset, ping, version, non-volatile memory; and the RPC error, which answers what the sink did not understand."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from wsn_tracking.zstack.commands.table import command


class Nv(IntEnum):
    """Items of the sink's non-volatile memory that forming a network sets."""

    STARTUP_OPTION = 0x0003
    PANID = 0x0083
    CHANLIST = 0x0084
    LOGICAL_TYPE = 0x0087
    ZDO_DIRECT_CB = 0x008F


SOFT_RESET = 1  # type 0 makes a CC2531 drop off the bus

RESET_REASONS = ('power-up', 'reset pin', 'watchdog')


@command(0x6000, 'RPC_ERROR', 'BBB')
class RpcError(NamedTuple):
    """Answer to a request that the sink did not understand; cmd0 and cmd1 are those of the request."""

    code: int
    cmd0: int
    cmd1: int

    @property
    def exchange(self) -> int:
        """As `Frame.exchange` of the request."""
        return (self.cmd0 << 8 | self.cmd1) & 0x1FFF

    @property
    def meaning(self) -> str:
        """In words."""
        words = {1: 'unknown subsystem', 2: 'unknown command', 3: 'invalid parameter', 4: 'invalid length'}
        return words.get(self.code, f'code {self.code}')


@command(0x4100, 'SYS_RESET_REQ', 'B')
class SysResetReq(NamedTuple):
    """Restart the sink."""

    type: int = SOFT_RESET


@command(0x4180, 'SYS_RESET_IND', 'BBBBBB')
class SysResetInd(NamedTuple):
    """The sink has restarted: its registrations are gone."""

    reason: int
    transport: int
    product: int
    major: int
    minor: int
    maintenance: int

    @property
    def cause(self) -> str:
        """The reason in words."""
        return RESET_REASONS[self.reason] if self.reason < len(RESET_REASONS) else f'reason {self.reason}'


@command(0x2101, 'SYS_PING')
class SysPing(NamedTuple):
    """Are you there."""


@command(0x6101, 'SYS_PING', 'H')
class SysPingRsp(NamedTuple):
    """Bits: SYS 1, MAC 2, NWK 4, AF 8, ZDO 0x10, SAPI 0x20, UTIL 0x40, DBG 0x80, APP 0x100."""

    capabilities: int


@command(0x2102, 'SYS_VERSION')
class SysVersion(NamedTuple):
    """What are you."""


@command(0x6102, 'SYS_VERSION', 'BBBBB?I?B?I')
class SysVersionRsp(NamedTuple):
    """Forms of 5, 9, 10 and 14 bytes; what is absent is None."""

    transport: int
    product: int  # 0 Z-Stack Home 1.2, 1 3.x.0, 2 3.0.x
    major: int
    minor: int
    maintenance: int
    revision: int | None = None
    build: int | None = None
    bootloader: int | None = None

    @property
    def stack(self) -> str:
        """The family of the firmware in words."""
        return {0: 'Z-Stack Home 1.2', 1: 'Z-Stack 3.x.0', 2: 'Z-Stack 3.0.x'}.get(
            self.product, f'product {self.product}'
        )

    def __str__(self) -> str:
        revision = '' if self.revision is None else f' revision {self.revision}'
        return f'{self.stack} ({self.major}.{self.minor}.{self.maintenance}{revision})'


@command(0x2108, 'SYS_OSAL_NV_READ', 'HB')
class NvRead(NamedTuple):
    """Read an item of the non-volatile memory."""

    item: int
    offset: int = 0


@command(0x6108, 'SYS_OSAL_NV_READ', 'B*B')
class NvReadRsp(NamedTuple):
    """What the item holds."""

    status: int
    value: bytes = b''


@command(0x2109, 'SYS_OSAL_NV_WRITE', 'HB*B')
class NvWrite(NamedTuple):
    """Write an item of the non-volatile memory: only forming a network does."""

    item: int
    offset: int
    value: bytes


@command(0x6109, 'SYS_OSAL_NV_WRITE', 'B')
class NvWriteRsp(NamedTuple):
    """Was it written."""

    status: int
