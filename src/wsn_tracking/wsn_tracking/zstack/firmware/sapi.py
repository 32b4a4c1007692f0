"""SAPI, the simple interface: settings by another door, starting the network, and who is where."""

from __future__ import annotations

from collections.abc import Iterable

from wsn_tracking.zstack.firmware.chip import Chip
from wsn_tracking.zstack.firmware.memory import SUCCESS
from wsn_tracking.zstack.firmware.nib import NO_NETWORK
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.firmware.zdp import sink_mote
from wsn_tracking.zstack.frames import Frame

SAPI = Table()
START_CONFIRM, FIND_CONFIRM = 0x4680, 0x4685
BY_IEEE = 1  # kind of search
ANSWER_S = 0.005


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


@SAPI.on(0x2600)
def start(chip: Chip) -> Iterable[Frame]:
    """ZB_START_REQUEST: confirmed when the network is up."""

    def confirm() -> list[Frame]:
        return [Frame(START_CONFIRM, bytes((SUCCESS,)))]

    (chip.form if chip.memory.network is NO_NETWORK else chip.restore)(confirm)
    return [srsp(0x2600)]


@SAPI.on(0x2606, 'B')
def device_info(chip: Chip, item: int) -> Iterable[Frame]:
    """ZB_GET_DEVICE_INFO: 8 bytes, whatever is asked for."""
    network = chip.network
    values = {
        0: chip.state,
        1: chip.memory.ieee,
        2: network.short,
        5: network.channel,
        6: network.pan_id,
        7: network.ext_pan,
    }
    return [srsp(0x2606, item, values.get(item, 0).to_bytes(8, 'little'))]


@SAPI.on(0x2607, 'Q')
def find(chip: Chip, ieee: int) -> Iterable[Frame]:
    """ZB_FIND_DEVICE_REQUEST: its network address, once it has answered."""
    found = [mote for mote in (sink_mote(chip), *chip.motes.values()) if mote.ieee == ieee]
    if found:
        key = found[0].short.to_bytes(2, 'little')
        told = Frame(FIND_CONFIRM, bytes((BY_IEEE,)) + key + ieee.to_bytes(8, 'little'))
        chip.later(ANSWER_S, lambda: [told])
    return [srsp(0x2607)]
