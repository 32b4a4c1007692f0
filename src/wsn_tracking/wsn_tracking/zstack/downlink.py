"""What the host says to the nodes: decoded, obeyed and kept."""

from __future__ import annotations

from collections import Counter, deque
from typing import NamedTuple

from wsn_tracking.zstack.firmware.chip import Sent
from wsn_tracking.zstack.payload import DOWN, Payload, decode_payload
from wsn_tracking.zstack.records import FeedbackRecord, SensingRecord
from wsn_tracking.zstack.traffic import Traffic

MAX_TOLD = 1000  # messages from the host that are kept


class Told(NamedTuple):
    """What the host has told the nodes: position feedback, or a sensing command."""

    time_s: float
    dst: int
    record: FeedbackRecord | SensingRecord


class Downlink:
    """Position feedback and sensing commands on their cluster; `told` keeps them for whoever wants to see them."""

    def __init__(self, cluster: int, traffic: Traffic, counters: Counter[str]) -> None:
        self.told: deque[Told] = deque(maxlen=MAX_TOLD)
        self._cluster = cluster
        self._traffic = traffic
        self._counters = counters

    def take(self, sent: deque[Sent]) -> None:
        """Everything that the sink has sent to nodes."""
        while sent:
            message = sent.popleft()
            payload = decode_payload(message.data)
            if message.cluster != self._cluster or not isinstance(payload, Payload) or payload.type not in DOWN:
                self._counters['not_understood'] += 1
                continue
            for record in payload.records:
                if isinstance(record, SensingRecord):
                    self._counters['sensing_command'] += 1
                    self._traffic.command(record)
                    self.told.append(Told(message.time_s, message.dst, record))
                elif isinstance(record, FeedbackRecord):
                    self._counters['feedback'] += 1
                    self.told.append(Told(message.time_s, message.dst, record))
