"""SYS, the board: timers, random numbers, power of the radio, converter, pins and the clock of the day."""

from __future__ import annotations

import calendar
import time
from collections.abc import Iterable

from wsn_tracking.zstack.firmware.chip import Chip
from wsn_tracking.zstack.firmware.memory import INVALID_PARAMETER, SUCCESS
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.frames import Frame

BOARD = Table()
TIMERS = 4
TIMER_EXPIRED = 0x4181
NOT_RUNNING = 0x06  # status of stopping a timer that does not run
MAX_POWER_DBM = 4  # of a CC2530
SUPPLY, TEMPERATURE = 0x0F, 0x0E  # channels of the converter
CONVERTED = {SUPPLY: 7123, TEMPERATURE: 5400}  # 3.0 V, and a warm room, of 2^13 at 1.15 V; open inputs are 0
PINS = 0x0F
YEAR_2000_S = 946_684_800  # from which the clock counts, on the host's


@BOARD.on(0x210A, 'BH')
def start_timer(chip: Chip, timer: int, milliseconds: int) -> Iterable[Frame]:
    """SYS_OSAL_START_TIMER."""
    if timer >= TIMERS:
        return [srsp(0x210A, INVALID_PARAMETER)]
    started = chip.timers[timer] = object()

    def expired() -> list[Frame]:
        if chip.timers.get(timer) is not started:  # stopped, or started again
            return []
        del chip.timers[timer]
        return [Frame(TIMER_EXPIRED, bytes((timer,)))]

    chip.later(milliseconds * 1e-3, expired)
    return [srsp(0x210A, SUCCESS)]


@BOARD.on(0x210B, 'B')
def stop_timer(chip: Chip, timer: int) -> Iterable[Frame]:
    """SYS_OSAL_STOP_TIMER."""
    if timer >= TIMERS:
        return [srsp(0x210B, INVALID_PARAMETER)]
    running = chip.timers.pop(timer, None)
    return [srsp(0x210B, SUCCESS if running else NOT_RUNNING)]


@BOARD.on(0x210C)
def random(chip: Chip) -> Iterable[Frame]:
    """SYS_RANDOM."""
    return [srsp(0x210C, chip.random.randbytes(2))]


@BOARD.on(0x210D, 'BB')
def convert(chip: Chip, channel: int, resolution: int) -> Iterable[Frame]:
    """SYS_ADC_READ."""
    return [srsp(0x210D, CONVERTED.get(channel, 0).to_bytes(2, 'little'))]


@BOARD.on(0x210E, 'BB')
def pins(chip: Chip, operation: int, value: int) -> Iterable[Frame]:
    """SYS_GPIO: 2 sets, 3 clears, 4 toggles; answered with the state of the four pins, whatever is asked."""
    after = {2: chip.pins | value, 3: chip.pins & ~value, 4: chip.pins ^ value}
    chip.pins = after.get(operation, chip.pins) & PINS
    return [srsp(0x210E, chip.pins)]


@BOARD.on(0x210F, 'Bb')
def tune(chip: Chip, operation: int, value: int) -> Iterable[Frame]:
    """SYS_STACK_TUNE: 0 is the power, 1 whether the receiver stays on when idle."""
    return [srsp(0x210F, value & 0xFF)]


@BOARD.on(0x2110, 'IBBBBBH')
def set_time(
    chip: Chip, seconds: int, hour: int, minute: int, second: int, month: int, day: int, year: int
) -> Iterable[Frame]:
    """SYS_SET_TIME: seconds since 2000, or, where they are 0, date and time."""
    if not seconds and not (hour < 24 and minute < 60 and second < 60 and 1 <= month <= 12 and 1 <= day <= 31):
        return [srsp(0x2110, INVALID_PARAMETER)]
    if not seconds:
        seconds = calendar.timegm((max(year, 2000), month, day, hour, minute, second)) - YEAR_2000_S
    chip.set_clock = seconds - chip.now
    return [srsp(0x2110, SUCCESS)]


@BOARD.on(0x2111)
def get_time(chip: Chip) -> Iterable[Frame]:
    """SYS_GET_TIME; a chip that was not told counts from its start."""
    seconds = int(chip.now + chip.set_clock) & 0xFFFFFFFF
    at = time.gmtime(seconds + YEAR_2000_S)
    parts = bytes((at.tm_hour, at.tm_min, at.tm_sec, at.tm_mon, at.tm_mday))
    return [srsp(0x2111, seconds.to_bytes(4, 'little'), parts, at.tm_year.to_bytes(2, 'little'))]


@BOARD.on(0x2114, 'b')
def set_power(chip: Chip, dbm: int) -> Iterable[Frame]:
    """SYS_SET_TX_POWER: answered with the power that was set [dBm]."""
    return [srsp(0x2114, min(dbm, MAX_POWER_DBM) & 0xFF)]
