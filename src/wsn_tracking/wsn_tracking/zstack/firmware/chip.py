"""The state of a simulated sink: memory, network, endpoints, clock and what is due later."""

from __future__ import annotations

import random
from collections import Counter, deque
from collections.abc import Callable, Iterable
from typing import NamedTuple

from wsn_tracking.zstack.agenda import Agenda
from wsn_tracking.zstack.commands import AfRegister, SysResetInd, ZdoStateChangeInd, encode
from wsn_tracking.zstack.firmware.flavour import Flavour
from wsn_tracking.zstack.firmware.items import Item
from wsn_tracking.zstack.firmware.memory import Memory
from wsn_tracking.zstack.firmware.nib import CHANNELS, NO_NETWORK, UNKNOWN_PAN, Network
from wsn_tracking.zstack.frames import Frame

HOLD, STARTING, UP = 0, 8, 9  # device states
TICK_US, TICK_MODULUS = 320, 0xFF0000
MAX_SENT = 1000  # messages to nodes that are kept for whoever wants to see them
BOOT_S = 0.02  # reset to SYS_RESET_IND, on a scale that tests can wait for
RESTORE_S = 0.02  # start of a network that is remembered
FORM_S = 0.1  # a scan, and a new network
BROADCAST = 0xFFFC  # addresses from here on are for several

Later = Callable[[], Iterable[Frame]]


class Mote(NamedTuple):
    """A radio in the sink's network."""

    short: int
    ieee: int
    router: bool = True
    lqi: int = 160


class Sent(NamedTuple):
    """A message that the host sent to a node."""

    time_s: float
    dst: int
    endpoint: int
    cluster: int
    data: bytes


class Chip:
    """Everything that requests may look at or change; `now` [s] is set before anything happens."""

    def __init__(self, flavour: Flavour, ieee: int, seed: int, first_tick: int = 0, now: float = 0.0) -> None:
        self.flavour = flavour
        self.memory = Memory(flavour, ieee)
        self.motes: dict[int, Mote] = {}  # by network address
        self.sent: deque[Sent] = deque(maxlen=MAX_SENT)
        self.counters: Counter[str] = Counter()
        self.now = now
        self.random = random.Random(seed)
        self.hears_from = now  # [s]
        self._first_tick = first_tick
        self._agenda: Agenda[Later] = Agenda()
        self._power_up()

    def _power_up(self) -> None:
        """RAM as after a start."""
        self.memory.boot()
        self.booted = self.now
        self.state = HOLD
        self.endpoints: dict[int, AfRegister] = {}
        self.groups: dict[tuple[int, int], bytes] = {}
        self.callbacks: set[int] = set()  # clusters of ZDO messages that are passed on as they are
        self.formation_channels = 0
        self.timers: dict[int, object] = {}  # those that run
        self.pins = 0
        self.set_clock = -self.now  # what the clock of the day is ahead of `now` [s]
        self._agenda.clear()

    # ---- time

    @property
    def ticks(self) -> int:
        """The clock that stamps messages; it starts anew with the chip."""
        return (self._first_tick + int((self.now - self.booted) * 1e6 / TICK_US)) % TICK_MODULUS

    def later(self, seconds: float, do: Later) -> None:
        """Do something, and say what it gives, after a while."""
        self._agenda.at(self.now + seconds, do)

    @property
    def due(self) -> float:
        """When the next of it is due."""
        return self._agenda.due

    def overdue(self, now: float) -> Later | None:
        """The next thing that is due by `now`; the chip's time goes on to it."""
        if self.due > now:
            return None
        due, do = self._agenda.take()
        self.now = max(self.now, due)
        return do

    # ---- the network

    @property
    def network(self) -> Network:
        """The network, while it is up."""
        return self.memory.network if self.state == UP else NO_NETWORK

    def reset(self, reason: int = 0) -> None:
        """Start anew: a while later, the sink says so; until then it is deaf. The clock of its messages starts at 0."""
        self._power_up()
        self._first_tick = 0
        self.hears_from = self.now + BOOT_S

        def say() -> list[Frame]:
            version = self.flavour.version
            numbers = (version.transport, version.product, version.major, version.minor, version.maintenance)
            return [encode(SysResetInd(reason, *numbers))]

        self.later(BOOT_S, say)

    def enter(self, state: int) -> list[Frame]:
        """Another device state, which is told."""
        self.state = state
        return [encode(ZdoStateChangeInd(state))]

    def restore(self, after: Later = tuple) -> None:
        """Start the network that is remembered."""
        self.later(RESTORE_S, lambda: [*self.enter(UP), *after()])

    def form(self, after: Later = tuple) -> None:
        """Form a network as memory says; without a key, with a random one."""
        if not any(self.memory.get(Item.KEY)):
            self.memory.put(Item.KEY, self.random.randbytes(16))
        for k in range(3):
            self.later(FORM_S * k / 3, lambda: self.enter(STARTING))

        def up() -> list[Frame]:
            self.memory.remember(self._chosen())
            return [*self.enter(UP), *after()]

        self.later(FORM_S, up)

    def _chosen(self) -> Network:
        memory = self.memory
        mask = self.formation_channels or int.from_bytes(memory.get(Item.CHANNELS), 'little')
        allowed = [channel for channel in CHANNELS if mask >> channel & 1] or [CHANNELS[0]]
        pan_id = int.from_bytes(memory.get(Item.PAN_ID), 'little')
        if pan_id >= UNKNOWN_PAN:
            pan_id = self.random.randrange(1, 0xFFF0)
        ext_pan = int.from_bytes(memory.get(Item.USE_EXT_PAN_ID), 'little') or memory.ieee
        return Network(allowed[0], pan_id, ext_pan, 0, mask)
