"""UTIL, SAPI and APP_CNF: who the sink is, its settings by another door, and forming a network on Z-Stack 3."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking.zstack.commands import BdbCommissioningNotification, UtilGetDeviceInfoRsp, encode
from wsn_tracking.zstack.firmware.chip import UP, Chip
from wsn_tracking.zstack.firmware.memory import INVALID_PARAMETER, SUCCESS
from wsn_tracking.zstack.firmware.nib import NO_NETWORK, UNKNOWN_ADDRESS
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.frames import Frame

UTIL, SAPI, APP_CNF = Table(), Table(), Table()
ANY_ROLE = 7  # a firmware that could be coordinator, router or end device
ASSOCIATED = 28  # bytes of a child in memory
MAX_CHILDREN = 16
IN_PROGRESS, BDB_SUCCESS, RESTORED = 1, 0, 13
STEERING, FORMATION = 2, 4


@UTIL.on(0x2700)
def device_info(chip: Chip) -> Iterable[Frame]:
    """UTIL_GET_DEVICE_INFO."""
    up = chip.state == UP
    children = tuple(sorted(chip.motes))[:MAX_CHILDREN] if up else ()
    short = chip.network.short if up else UNKNOWN_ADDRESS
    return [encode(UtilGetDeviceInfoRsp(0, chip.memory.ieee, short, ANY_ROLE, chip.state, children))]


@UTIL.on(0x2706, 'HB')
def subscribe(chip: Chip, subsystem: int, enable: int) -> Iterable[Frame]:
    """UTIL_CALLBACK_SUB_CMD."""
    return [srsp(0x2706, SUCCESS)]


@UTIL.on(0x2709)
def time_alive(chip: Chip) -> Iterable[Frame]:
    """UTIL_TIME_ALIVE."""
    return [srsp(0x2709, int(max(chip.now - chip.booted, 0.0)).to_bytes(4, 'little'))]


@UTIL.on(0x270A, 'BB')
def led(chip: Chip, number: int, mode: int) -> Iterable[Frame]:
    """UTIL_LED_CONTROL."""
    return [srsp(0x270A, SUCCESS)]


@UTIL.on(0x2748, 'BB')
def count_children(chip: Chip, first: int, last: int) -> Iterable[Frame]:
    """UTIL_ASSOC_COUNT."""
    return [srsp(0x2748, len(chip.motes).to_bytes(2, 'little'))]


@UTIL.on(0x2749, 'B')
def find_child(chip: Chip, number: int) -> Iterable[Frame]:
    """UTIL_ASSOC_FIND_DEVICE: its table of children is empty, its motes are routers."""
    return [srsp(0x2749, b'\xff' * ASSOCIATED)]


@UTIL.on(0x274A, 'QH')
def child_at(chip: Chip, ieee: int, short: int) -> Iterable[Frame]:
    """UTIL_ASSOC_GET_WITH_ADDRESS."""
    return [srsp(0x274A, b'\xff' * ASSOCIATED)]


@SAPI.on(0x4609)
def reset(chip: Chip) -> Iterable[Frame]:
    """ZB_SYSTEM_RESET."""
    chip.reset(reason=0)
    return ()


@SAPI.on(0x2604, 'B')
def read_configuration(chip: Chip, item: int) -> Iterable[Frame]:
    """ZB_READ_CONFIGURATION: the memory, keys too."""
    status, value = chip.memory.read(item, 0, guarded=False)
    return [srsp(0x2604, status, item, len(value), value)]


@SAPI.on(0x2605, 'B*B')
def write_configuration(chip: Chip, item: int, value: bytes) -> Iterable[Frame]:
    """ZB_WRITE_CONFIGURATION."""
    return [srsp(0x2605, chip.memory.write(item, 0, value))]


@SAPI.on(0x2608, 'HB')
def permit_joining(chip: Chip, dst: int, seconds: int) -> Iterable[Frame]:
    """ZB_PERMIT_JOINING_REQUEST."""
    return [srsp(0x2608, SUCCESS)]


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
