"""The sink's end of the line: what it says goes out while it is plugged in and not mute; all else is lost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from enum import Enum

from wsn_tracking.zstack.agenda import Agenda
from wsn_tracking.zstack.faults import Fault
from wsn_tracking.zstack.wire import Wire

QUIET_S = 0.03  # of the line, after which faults give out what they hold back


class Plug(Enum):
    """What happens to the port."""

    IN = 'in'
    OUT = 'out'


Action = bytes | Plug


class Outlet:
    """Turns what is said into actions, each at its time by `clock`; `agenda` holds what is to be done later."""

    def __init__(
        self,
        faults: Sequence[Fault],
        baud: int,
        agenda: Agenda[Callable[[], None]],
        clock: Callable[[], float],
        counters: Counter[str],
    ) -> None:
        self._faults = faults
        self._agenda = agenda
        self._clock = clock
        self._counters = counters
        self._wire = Wire(faults, baud, agenda.at, self.put)
        self._actions: list[Action] = []
        self._muted_until = clock()
        self._plugged = True

    @property
    def is_open(self) -> bool:
        """Whether anything passes, either way."""
        return self._plugged and self._clock() >= self._muted_until

    @property
    def waits(self) -> bool:
        """Whether there is something to be taken."""
        return bool(self._actions)

    def take(self) -> list[Action]:
        """What is to be done by now, in order."""
        actions, self._actions = self._actions, []
        return actions

    def write(self, data: bytes) -> None:
        """Say bytes that belong together, over the wire and whatever goes wrong on it."""
        if self.is_open:
            self._wire.write(data, self._clock())
            if self._faults:
                self._agenda.at(self._clock() + QUIET_S, lambda: self._wire.flush(self._clock()))

    def put(self, data: bytes) -> None:
        """Bytes that are on the line now."""
        if data and self.is_open:
            self._counters['bytes_said'] += len(data)
            self._actions.append(data)

    def put_first(self) -> None:
        """What lies on the line before the sink says anything."""
        self.put(b''.join(fault.at_plug() for fault in self._faults))

    def mute(self, until: float) -> None:
        """Nothing passes until then."""
        self._muted_until = until

    def plug_in(self) -> None:
        """The port appears."""
        self._plugged = True
        self._actions.append(Plug.IN)
        self.put_first()

    def pull(self) -> None:
        """The port vanishes, and what was underway with it."""
        self._plugged = False
        self._wire.clear()
        self._actions.append(Plug.OUT)
