"""Questions and answers without a line between them, on a clock that the test moves."""

import types

import pytest

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack import dialogue as module
from wsn_tracking.zstack.counters import new_counters
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.line import Heard
from wsn_tracking.zstack.settings import TimeoutConfig


class Line:
    """Each hearing takes so long, and brings what the script says."""

    def __init__(self, clock, *script):
        self.clock, self.script, self.said = clock, list(script), []

    def hear(self, until):
        seconds, *items = self.script.pop(0) if self.script else (max(until - self.clock.now, 0.0),)
        self.clock.now += seconds
        return Heard(items, 0)

    def say(self, command):
        self.said.append(command)


@pytest.fixture
def clock(monkeypatch):
    fake = types.SimpleNamespace(now=100.0)
    fake.monotonic = lambda: fake.now
    monkeypatch.setattr(module, 'time', fake)
    return fake


def asking(clock, *script):
    return Dialogue(Line(clock, *script), TimeoutConfig(ping=0.5), new_counters())


def test_answer_that_lay_ready_while_the_host_was_held_up_counts(clock):
    dialogue = asking(clock, (0.4,), (7.0,), (0.0, c.SysPingRsp(1)))
    assert dialogue.ask(c.SysPing(), c.SysPingRsp, 0.5) == c.SysPingRsp(1)
    assert clock.now == pytest.approx(107.4)


def test_no_answer_is_waited_for_as_long_as_is_said_and_no_longer(clock):
    dialogue = asking(clock)
    with pytest.raises(TrackingError, match='does not answer SYS_PING'):
        dialogue.ask(c.SysPing(), c.SysPingRsp, 0.5, tries=3)
    assert clock.now == pytest.approx(101.5)
    assert (len(dialogue.line.said), dialogue.counters['no_answers']) == (3, 3)
