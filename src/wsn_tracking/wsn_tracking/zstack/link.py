"""How the link to a sink is, and what is told of it."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.commands import ZdoExtNwkInfoRsp
from wsn_tracking.zstack.startup import Sink


class LinkEvent(NamedTuple):
    """Comes among the reports: `opened`, `restarted` (the sink's clock is new), `up`, or `lost` and why."""

    kind: str
    words: str = ''


class Status(NamedTuple):
    """How the link is; `error` is why it was lost, while it is."""

    phase: str = 'closed'  # opening, probing, attaching, up, lost
    port: str = ''
    device: str = ''  # what the port's name stands for
    sink: Sink | None = None
    network: ZdoExtNwkInfoRsp | None = None
    error: str = ''

    @property
    def up(self) -> bool:
        """Whether reports can come."""
        return self.phase == 'up'
