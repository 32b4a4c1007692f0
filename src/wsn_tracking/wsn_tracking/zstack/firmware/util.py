"""UTIL: who the sink is, its settings by a second door, and whose address is which."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking.zstack.commands import UtilGetDeviceInfoRsp, encode
from wsn_tracking.zstack.firmware.chip import UP, Chip
from wsn_tracking.zstack.firmware.items import Item
from wsn_tracking.zstack.firmware.memory import SUCCESS
from wsn_tracking.zstack.firmware.nib import UNKNOWN_ADDRESS
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.firmware.zdp import sink_mote
from wsn_tracking.zstack.frames import Frame
from wsn_tracking.zstack.layout import Layout

UTIL = Table()
ANY_ROLE = 7  # a firmware that could be coordinator, router or end device
ASSOCIATED = 28  # bytes of a child in memory
MAX_CHILDREN = 16
NO_IEEE = (1 << 64) - 1


@UTIL.on(0x2700)
def device_info(chip: Chip) -> Iterable[Frame]:
    """UTIL_GET_DEVICE_INFO."""
    up = chip.state == UP
    children = tuple(sorted(chip.motes))[:MAX_CHILDREN] if up else ()
    short = chip.network.short if up else UNKNOWN_ADDRESS
    return [encode(UtilGetDeviceInfoRsp(0, chip.memory.ieee, short, ANY_ROLE, chip.state, children))]


@UTIL.on(0x2701)
def settings(chip: Chip) -> Iterable[Frame]:
    """UTIL_GET_NV_INFO: address, channels, PAN, security level and key."""
    memory = chip.memory
    items = (Item.EXTADDR, Item.CHANNELS, Item.PAN_ID, Item.SECURITY_LEVEL, Item.KEY)
    return [srsp(0x2701, SUCCESS, *(memory.get(item) for item in items))]


def _sets(header: int, item: Item, layout: str) -> None:
    """The command that writes one item."""

    def write(chip: Chip, *values: int) -> Iterable[Frame]:
        return [srsp(header, chip.memory.write(item, 0, Layout(layout).pack(values)))]

    UTIL.on(header, layout)(write)


# PAN, channels, security level, key
for _header, _item, _layout in (
    (0x2702, Item.PAN_ID, 'H'),
    (0x2703, Item.CHANNELS, 'I'),
    (0x2704, Item.SECURITY_LEVEL, 'B'),
    (0x2705, Item.KEY, 'QQ'),
):
    _sets(_header, _item, _layout)


@UTIL.on(0x2740, 'Q')
def short_of(chip: Chip, ieee: int) -> Iterable[Frame]:
    """UTIL_ADDRMGR_EXT_ADDR_LOOKUP."""
    found = (mote.short for mote in (sink_mote(chip), *chip.motes.values()) if mote.ieee == ieee)
    return [srsp(0x2740, next(found, UNKNOWN_ADDRESS).to_bytes(2, 'little'))]


@UTIL.on(0x2741, 'H')
def ieee_of(chip: Chip, short: int) -> Iterable[Frame]:
    """UTIL_ADDRMGR_NWK_ADDR_LOOKUP."""
    found = (mote.ieee for mote in (sink_mote(chip), *chip.motes.values()) if mote.short == short)
    return [srsp(0x2741, next(found, NO_IEEE).to_bytes(8, 'little'))]


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
