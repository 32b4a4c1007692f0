"""SYS: reset, ping, version, memory."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking.zstack.commands import SysPingRsp, SysVersionRsp, encode
from wsn_tracking.zstack.firmware.chip import Chip
from wsn_tracking.zstack.firmware.items import Item
from wsn_tracking.zstack.firmware.memory import INVALID_PARAMETER, SUCCESS
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.frames import Frame

SYS = Table()
READ, READ_EXT, WRITE, WRITE_EXT = 0x2108, 0x211C, 0x2109, 0x211D


@SYS.on(0x4100, 'B')
def reset(chip: Chip, kind: int) -> Iterable[Frame]:
    """SYS_RESET_REQ: any type; the chip has no bus to drop off."""
    chip.reset(reason=0)
    return ()


@SYS.on(0x2101)
def ping(chip: Chip) -> Iterable[Frame]:
    """SYS_PING."""
    return [encode(SysPingRsp(chip.flavour.capabilities))]


@SYS.on(0x2102)
def version(chip: Chip) -> Iterable[Frame]:
    """SYS_VERSION."""
    answer: SysVersionRsp = chip.flavour.version
    return [encode(answer)]


@SYS.on(0x2103, 'Q')
def set_ieee(chip: Chip, ieee: int) -> Iterable[Frame]:
    """SYS_SET_EXTADDR."""
    chip.memory.put(Item.EXTADDR, ieee.to_bytes(8, 'little'))
    return [srsp(0x2103, SUCCESS)]


@SYS.on(0x2104)
def get_ieee(chip: Chip) -> Iterable[Frame]:
    """SYS_GET_EXTADDR."""
    return [srsp(0x2104, chip.memory.get(Item.EXTADDR))]


@SYS.on(0x2107, 'HH*B')
def create(chip: Chip, item: int, length: int, data: bytes) -> Iterable[Frame]:
    """SYS_OSAL_NV_ITEM_INIT."""
    return [srsp(0x2107, chip.memory.create(item, length, data))]


@SYS.on(0x2112, 'HH')
def delete(chip: Chip, item: int, length: int) -> Iterable[Frame]:
    """SYS_OSAL_NV_DELETE."""
    return [srsp(0x2112, chip.memory.delete(item, length))]


@SYS.on(0x2113, 'H')
def length_of(chip: Chip, item: int) -> Iterable[Frame]:
    """SYS_OSAL_NV_LENGTH."""
    return [srsp(0x2113, chip.memory.length(item).to_bytes(2, 'little'))]


@SYS.on(READ, 'HB')
def read(chip: Chip, item: int, offset: int) -> Iterable[Frame]:
    """SYS_OSAL_NV_READ."""
    status, value = chip.memory.read(item, offset)
    return [srsp(READ, status, len(value), value)]


@SYS.on(READ_EXT, 'HH')
def read_ext(chip: Chip, item: int, offset: int) -> Iterable[Frame]:
    """SYS_OSAL_NV_READ_EXT: a wider offset."""
    status, value = chip.memory.read(item, offset)
    return [srsp(READ_EXT, status, len(value), value)]


@SYS.on(WRITE, 'HB*B')
def write(chip: Chip, item: int, offset: int, data: bytes) -> Iterable[Frame]:
    """SYS_OSAL_NV_WRITE."""
    return [srsp(WRITE, chip.memory.write(item, offset, data))]


@SYS.on(WRITE_EXT, 'HHH$')
def write_ext(chip: Chip, item: int, offset: int, length: int, data: bytes) -> Iterable[Frame]:
    """SYS_OSAL_NV_WRITE_EXT: a wider offset, and length."""
    status = chip.memory.write(item, offset, data[:length]) if len(data) >= length else INVALID_PARAMETER
    return [srsp(WRITE_EXT, status)]
