"""A simulated sink on a pseudo terminal for tests, what its line delivered, and a host that hears it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from wsn_tracking.airwaves import on_board
from wsn_tracking.sink_thread import SinkThread
from wsn_tracking.zstack.clock import ClockConfig
from wsn_tracking.zstack.intake import Intake, Taken
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.lqi import SCALES
from wsn_tracking.zstack.motes import Message, TrafficConfig
from wsn_tracking.zstack.payload import Payload
from wsn_tracking.zstack.queues import Received
from wsn_tracking.zstack.readings import AirEpoch
from wsn_tracking.zstack.session import Session
from wsn_tracking.zstack.settings import LinkConfig, TimeoutConfig
from wsn_tracking.zstack.simulator_settings import SimulatorConfig

PATIENCE = 60.0  # [s] far beyond what anything takes on a machine that is busy
QUIET = TrafficConfig(heartbeat=0.0)
LIVE = {  # settings of the live graph
    'period': 0.1,
    'epoch_timeout': 2.0,  # beyond any pause within an epoch: nothing comes late, however busy the machine is
    'loss_timeout': PATIENCE,
    'fusion_timeout': PATIENCE,
    'area': [0.0, 0.0, 3.6, 2.4],
    'target_height': 0.0,
    'timeout.settle': 0.01,
    'timeout.reopen_first': 0.05,
    'timeout.reopen_last': 0.1,
}


# Quick where nothing goes wrong, and so patient that no pause of a busy machine passes for a fault of the line.
PATIENT = TimeoutConfig(
    settle=0.01,
    gap=1.0,
    ping=2.0,
    wake=0.05,
    reply=2.0,
    tries=20,
    startup=10.0,
    reset=30.0,
    commissioning=30.0,
    idle=0.05,
    misses=100,
    reopen_first=0.02,
    reopen_last=0.05,
)


def until(condition: Callable[[], object], what: str) -> None:
    """Wait for a condition."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f'not within {PATIENCE:g} s: {what}'
        time.sleep(0.005)


class Said(NamedTuple):
    """A payload that the sink's radio has received, and whether the host was given it."""

    payload: Payload
    given: bool


class Radio(SinkThread):
    """`said` tells what the line delivered: that has to arrive."""

    def __init__(self, link: object, world: Sequence[AirEpoch], **config: Any) -> None:
        settings = SimulatorConfig(link=str(link), **{'traffic': QUIET, **config})
        super().__init__(settings, world, on_board(settings.traffic.alpha))
        self.said: list[Said] = []
        self.simulator.witness = self._note

    @property
    def given(self) -> list[Payload]:
        """What the line delivered."""
        return [said.payload for said in list(self.said) if said.given]

    def _note(self, message: Message, given: bool) -> None:
        self.said.append(Said(message.payload, given))


Measured = list[tuple[int, int | None, int | None]]  # node, beacon, rssi


def measured(payloads: Sequence[Payload]) -> Measured:
    """What payloads tell, sorted."""
    return sorted((p.node_id, r.beacon_seq, r.rssi_dbm) for p in payloads for r in p.records)


class Heard:
    """A session of this project with its intake: what was delivered, and what is new of it."""

    def __init__(self, link: object, **config: Any) -> None:
        self.session = Session(LinkConfig(port=str(link), **{'timeout': PATIENT, **config}))
        self.received: list[Received] = []
        self.new: list[Taken] = []
        self._intake = Intake(ClockConfig(), SCALES['cc2530'])

    def take(self) -> None:
        """Whatever has come."""
        received = self.session.inbox.take()
        self.received += received
        self.new += [taken for taken in map(self._intake.take, received) if taken is not None and taken.is_new]

    def events(self, kind: str) -> list[str]:
        """The words of the events of that kind."""
        self.take()
        return [item.words for item, _ in self.received if isinstance(item, LinkEvent) and item.kind == kind]

    @property
    def counters(self) -> dict[str, int]:
        """Those of the link and of the intake."""
        return {**self.session.counters, **self._intake.counters}

    @property
    def measured(self) -> Measured:
        """What is new of the measurements."""
        self.take()
        return measured([taken.report.payload for taken in self.new])

    def until_up(self, times: int = 1) -> None:
        """So many times so far."""
        until(lambda: len(self.events('up')) >= times, f'up {times} times')

    def after(self, radio: Radio) -> Heard:
        """Everything: the world is told, and the sink has answered a ping after that, in the order of the line."""
        until(lambda: radio.loop.finished, 'the end of the world')
        heard = radio.simulator.counters['bytes_heard']
        until(lambda: radio.simulator.counters['bytes_heard'] >= heard + 10, 'two pings')
        self.take()
        return self

    def through(self, radio: Radio) -> Heard:
        """The whole world, from the moment at which the link is up."""
        self.until_up()
        radio.may_begin.set()
        return self.after(radio)
