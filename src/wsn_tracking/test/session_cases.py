"""A session on a fake sink that answers at once: its host, its patience, and what both say."""

import dataclasses
import time

from fake_sink import PATIENCE
from zstack_cases import line_bytes, message, report_payload

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.records import FeedbackRecord
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.session import Session
from wsn_tracking.zstack.settings import LinkConfig, TimeoutConfig

FAST = TimeoutConfig(
    settle=0.01,
    gap=0.05,
    ping=0.3,
    wake=0.05,
    reply=0.5,
    startup=0.5,
    reset=1.0,
    commissioning=0.5,
    idle=5.0,
    confirm=0.5,
    reopen_first=0.02,
    reopen_last=0.05,
)
IMPATIENT = dataclasses.replace(FAST, idle=0.05, ping=0.05)
FEEDBACK = encode_payload(Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(1, 0.5, 0.5, 0.0, 0.0),)))
WRITES = (c.NvWrite, c.SysResetReq, c.BdbSetChannel, c.BdbStartCommissioning)


class Host:
    """A session, and what came out of it."""

    def __init__(self, link, **config):
        self.session = Session(LinkConfig(port=str(link), **{'timeout': FAST, **config}))
        self.received = []
        self.session.start()

    def until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, (self.session.status, self.session.counters, self.received)
            self.received += self.session.inbox.take(0.05)

    def wait_up(self, times=1):
        self.until(lambda: self.events('up') >= times)

    def wait_seqs(self, seqs):
        self.until(lambda: len(self.seqs) >= len(seqs))
        assert self.seqs == list(seqs)

    def wait_counted(self, name, n=1):
        self.until(lambda: self.session.counters[name] >= n)

    def events(self, kind):
        return sum(isinstance(r.item, LinkEvent) and r.item.kind == kind for r in self.received)

    @property
    def seqs(self):
        return [r.item.payload.seq for r in self.received if isinstance(r.item, Report)]

    def counted(self, name):
        return self.session.counters[name]


def data(seq, **more):
    """The bytes of a report."""
    return line_bytes(message(report_payload(seq=seq), ticks=1000 * seq, **more))


def comes_through(up, sink, seq):
    """A condition: the report is said until it is heard; noise before it may have begun a frame that takes some in."""

    def heard():
        sink.say(data(seq))
        up.received += up.session.inbox.take(0.05)
        return seq in up.seqs

    return heard
