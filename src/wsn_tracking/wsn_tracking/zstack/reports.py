"""What every kind of sink delivers: a node's payload, and what the radio says of how it came."""

from __future__ import annotations

from typing import NamedTuple

from wsn_tracking.zstack.payload import Payload
from wsn_tracking.zstack.records import RssiRecord


class Report(NamedTuple):
    """A payload as it came in; None is what this kind of sink does not say."""

    payload: Payload
    src: int | None = None  # network address of the node
    lqi: int | None = None  # of the last hop into the sink
    hops: int | None = None
    ticks: int | None = None  # sink clock at reception
    mac_src: int | None = None  # who transmitted the last hop
    per_robot: bool = False  # each robot of a payload comes as a report of its own, under the same number

    @property
    def direct(self) -> bool | None:
        """Was the node heard by the sink itself."""
        return None if self.mac_src is None else self.mac_src == self.src

    @property
    def stream(self) -> tuple[int, int]:
        """Reports of the same stream count their numbers together: the node, and the robot where that is told apart."""
        record = self.payload.records[0] if self.per_robot and self.payload.records else None
        return self.payload.node_id, record.robot_id if isinstance(record, RssiRecord) else -1
