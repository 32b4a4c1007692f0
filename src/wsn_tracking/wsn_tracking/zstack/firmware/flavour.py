"""The two firmwares that CC2530 sinks run, as they present themselves."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.commands import SysVersionRsp

# bits of SYS_PING beside those in `commands.sys`
GREEN_POWER, APP_CNF = 0x0200, 0x0400


class Flavour(NamedTuple):
    """What differs between the firmwares."""

    name: str
    capabilities: int
    version: SysVersionRsp
    has_bdb: bool  # networks are formed by APP_CNF
    already_registered: int  # status of a second AF_REGISTER of an endpoint
    guards_keys: bool  # keys cannot be read by SYS commands


HOME_1_2 = Flavour(
    'home_1_2',
    capabilities=0x0179,  # SYS, AF, ZDO, SAPI, UTIL, APP
    version=SysVersionRsp(2, 0, 2, 6, 3, 20190425, 2, 0),
    has_bdb=False,
    already_registered=0x02,
    guards_keys=True,
)
ZSTACK_3_0 = Flavour(
    'zstack_3_0',
    capabilities=0x0059 | GREEN_POWER | APP_CNF,  # SYS, AF, ZDO, UTIL
    version=SysVersionRsp(2, 2, 2, 7, 2, 20190425, 2, 0),
    has_bdb=True,
    already_registered=0xB8,
    guards_keys=False,
)
FLAVOURS = {flavour.name: flavour for flavour in (HOME_1_2, ZSTACK_3_0)}
