"""A sink without its radio: what a CC2530 with Z-Stack answers to a host, as frames in, frames out, at given times."""

from __future__ import annotations

from collections.abc import Mapping

from wsn_tracking.zstack.commands import AfIncomingMsg, RpcError, encode
from wsn_tracking.zstack.firmware.af import AF
from wsn_tracking.zstack.firmware.app_cnf import APP_CNF
from wsn_tracking.zstack.firmware.board import BOARD
from wsn_tracking.zstack.firmware.chip import UP, Chip
from wsn_tracking.zstack.firmware.flavour import HOME_1_2, Flavour
from wsn_tracking.zstack.firmware.items import Item
from wsn_tracking.zstack.firmware.nib import Network
from wsn_tracking.zstack.firmware.reader import FirmwareReader
from wsn_tracking.zstack.firmware.sapi import SAPI
from wsn_tracking.zstack.firmware.sys import SYS
from wsn_tracking.zstack.firmware.table import Handler, take
from wsn_tracking.zstack.firmware.util import UTIL
from wsn_tracking.zstack.firmware.zdo import ZDO
from wsn_tracking.zstack.frames import MAX_DATA, Frame, Kind, encode_frame
from wsn_tracking.zstack.protocols import Radio

IEEE = 0x00124B0012345678
DEFAULT_NETWORK = Network(11, 0x1A62, 0xDDDDDDDDDDDDDDDD, 0, 1 << 11)
DEFAULT_KEY = bytes.fromhex('7a1f4c90d3526be8051c9e47b2f06d38')
UNKNOWN_SUBSYSTEM, UNKNOWN_COMMAND, WRONG_LENGTH = 1, 2, 4
SYSTEM = {**SYS.handlers, **BOARD.handlers}
TABLES: Mapping[int, Mapping[int, Handler]] = {
    1: SYSTEM,
    4: AF.handlers,
    5: ZDO.handlers,
    6: SAPI.handlers,
    7: UTIL.handlers,
    15: APP_CNF.handlers,
}


class Device:
    """Feed it what the host says; it keeps the firmware's state. Times are in s and do not go back."""

    def __init__(
        self,
        flavour: Flavour = HOME_1_2,
        *,
        ieee: int = IEEE,
        network: Network | None = DEFAULT_NETWORK,
        up: bool = False,
        seed: int = 0,
        first_tick: int = 0,
        now: float = 0.0,
    ) -> None:
        """`network`: the one that it remembers; `up`: it is started already, as after a restart of the host."""
        self.chip = Chip(flavour, ieee, seed, first_tick, now)
        self.reader = FirmwareReader()
        self._tables: Mapping[int, Mapping[int, Handler]] = {
            number: table for number, table in TABLES.items() if _has(flavour, number)
        }
        if network is not None:
            self.chip.memory.put(Item.PAN_ID, network.pan_id.to_bytes(2, 'little'))
            self.chip.memory.put(Item.KEY, DEFAULT_KEY)
            self.chip.memory.put(Item.CHANNELS, (1 << network.channel).to_bytes(4, 'little'))
            self.chip.memory.remember(network)
            self.chip.state = UP if up else self.chip.state

    def feed(self, data: bytes, now: float) -> bytes:
        """Everything that the sink says to those bytes, and what was due until `now`."""
        said = self.advance(now)
        for request in self.reader.feed(data):
            said += self.answer(request, now)
        return b''.join(map(encode_frame, said))

    def answer(self, request: Frame, now: float) -> list[Frame]:
        """What the sink says at once to a frame; what comes later is said by `advance`."""
        self.chip.now = max(self.chip.now, now)
        if self.chip.now < self.chip.hears_from:
            return []
        table = self._tables.get(request.subsystem)
        handler = None if table is None else table.get(request.header)
        answer = None
        if handler is not None and len(request.data) <= MAX_DATA:
            answer = take(handler, self.chip, request.data)
        if answer is not None:
            return answer
        if request.kind != Kind.SREQ:
            return []
        error = UNKNOWN_SUBSYSTEM if table is None else UNKNOWN_COMMAND if handler is None else WRONG_LENGTH
        return self.refuse(request, error)

    def refuse(self, request: Frame, error: int = UNKNOWN_COMMAND) -> list[Frame]:
        """What the sink says to a request that it does not understand."""
        self.chip.counters['rpc_errors'] += 1
        return [encode(RpcError(error, request.header >> 8, request.header & 0xFF))]

    def advance(self, now: float) -> list[Frame]:
        """What was due until `now`."""
        said: list[Frame] = []
        while (do := self.chip.overdue(now)) is not None:
            said += do()
        self.chip.now = max(self.chip.now, now)
        return said

    @property
    def due(self) -> float:
        """When `advance` will have something to say."""
        return self.chip.due

    def delivers(self, radio: Radio) -> bool:
        """Whether messages to our endpoint reach the host: the network is up, and the endpoint registered."""
        return self.chip.state == UP and radio.endpoint in self.chip.endpoints

    def incoming(self, message: AfIncomingMsg, now: float) -> list[Frame]:
        """A message of a node: passed on with the sink's time, where somebody registered its endpoint."""
        self.chip.now = max(self.chip.now, now)
        if self.chip.state != UP or message.dst_endpoint not in self.chip.endpoints:
            self.chip.counters['undelivered'] += 1
            return []
        return [encode(message._replace(timestamp=self.chip.ticks))]

    def reset(self, now: float, reason: int = 2) -> None:
        """The sink restarts on its own (2: its watchdog)."""
        self.chip.now = max(self.chip.now, now)
        self.reader.reset()
        self.chip.reset(reason)

    def power_cycle(self, now: float) -> None:
        """Power is lost and comes back: nothing but memory is left. A port shows when there is somebody to hear."""
        self.reset(now, reason=0)
        self.chip.hears_from = self.chip.now


def _has(flavour: Flavour, subsystem: int) -> bool:
    bit = {6: 0x20, 15: 0x400}.get(subsystem, 0)
    return not bit or bool(flavour.capabilities & bit)
