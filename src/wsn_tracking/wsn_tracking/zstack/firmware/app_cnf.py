"""APP_CNF: forming a network on Z-Stack 3."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking.zstack.commands import BdbCommissioningNotification, encode
from wsn_tracking.zstack.firmware.chip import Chip
from wsn_tracking.zstack.firmware.memory import INVALID_PARAMETER, SUCCESS
from wsn_tracking.zstack.firmware.nib import NO_NETWORK
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.frames import Frame

APP_CNF = Table()
IN_PROGRESS, BDB_SUCCESS, RESTORED = 1, 0, 13
STEERING, FORMATION = 2, 4


@APP_CNF.on(0x2F08, 'BI')
def set_channel(chip: Chip, primary: int, mask: int) -> Iterable[Frame]:
    """APP_CNF_BDB_SET_CHANNEL."""
    if primary:
        chip.formation_channels = mask
    return [srsp(0x2F08, SUCCESS)]


@APP_CNF.on(0x2F05, 'B')
def commission(chip: Chip, mode: int) -> Iterable[Frame]:
    """APP_CNF_BDB_START_COMMISSIONING: forms a network, or restores the one that is remembered."""
    if not mode & FORMATION:
        return [srsp(0x2F05, INVALID_PARAMETER)]
    if chip.memory.network is not NO_NETWORK:
        chip.restore(lambda: [_tell(RESTORED, 0, FORMATION), _tell(BDB_SUCCESS, FORMATION, 0)])
        return [srsp(0x2F05, SUCCESS)]
    chip.form(lambda: [_tell(BDB_SUCCESS, STEERING, 0)])
    chip.later(0.0, lambda: [_tell(IN_PROGRESS, STEERING, FORMATION)])
    return [srsp(0x2F05, SUCCESS)]


def _tell(status: int, mode: int, remaining: int) -> Frame:
    return encode(BdbCommissioningNotification(status, mode, remaining))


def _accept(header: int, layout: str) -> None:
    """A setting that changes nothing which a host could see."""

    def accepted(chip: Chip, *fields: int | bytes) -> Iterable[Frame]:
        return [srsp(header, SUCCESS)]

    APP_CNF.on(header, layout)(accepted)


# frame counter, timeouts of end devices, rejoining, install codes and keys of those that join
for _header, _layout in (
    (0x2FFF, 'QI'),
    (0x2F01, 'B'),
    (0x2F02, 'B'),
    (0x2F03, 'B'),
    (0x2F04, 'BQ$'),
    (0x2F06, 'B'),
    (0x2F07, 'B$'),
    (0x2F09, 'B'),
):
    _accept(_header, _layout)
