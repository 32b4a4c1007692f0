"""A simulated sink on a pseudo terminal for tests, and what its line delivered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from wsn_tracking.airwaves import on_board
from wsn_tracking.zstack.payload import Payload
from wsn_tracking.zstack.simulator_settings import SimulatorConfig
from wsn_tracking.zstack.sink_thread import SinkThread
from wsn_tracking.zstack.traffic import AirEpoch, Message, TrafficConfig

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
