"""UTIL and APP_CNF: what the sink is, and forming a network on Z-Stack 3."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.commands.table import command

FORMATION = 4  # mode of BDB_START_COMMISSIONING


@command(0x2700, 'UTIL_GET_DEVICE_INFO')
class UtilGetDeviceInfo(NamedTuple):
    """Who are you, and are you up."""


@command(0x6700, 'UTIL_GET_DEVICE_INFO', 'BQHBB*H')
class UtilGetDeviceInfoRsp(NamedTuple):
    """State 9 is a coordinator that is up."""

    status: int
    ieee: int
    short: int
    type: int
    state: int
    associated: tuple[int, ...] = ()


@command(0x2F08, 'APP_CNF_BDB_SET_CHANNEL', 'BI')
class BdbSetChannel(NamedTuple):
    """Channels to form on (primary 1) and to fall back to (primary 0), as bits."""

    primary: int
    mask: int


@command(0x6F08, 'APP_CNF_BDB_SET_CHANNEL', 'B')
class BdbSetChannelRsp(NamedTuple):
    """Was it set."""

    status: int


@command(0x2F05, 'APP_CNF_BDB_START_COMMISSIONING', 'B')
class BdbStartCommissioning(NamedTuple):
    """Form a network."""

    mode: int = FORMATION


@command(0x6F05, 'APP_CNF_BDB_START_COMMISSIONING', 'B')
class BdbStartCommissioningRsp(NamedTuple):
    """Has it begun."""

    status: int


@command(0x4F80, 'APP_CNF_BDB_COMMISSIONING_NOTIFICATION', 'BBB')
class BdbCommissioningNotification(NamedTuple):
    """How forming goes."""

    status: int
    mode: int
    remaining: int
