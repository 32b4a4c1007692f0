"""Listening to a sink for a while, without a thread: for the command line."""

from __future__ import annotations

import contextlib
import time

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import (
    COORDINATOR_UP,
    AfRegister,
    AfRegisterRsp,
    ZdoMgmtLqiReq,
    ZdoMgmtLqiReqRsp,
)
from wsn_tracking.zstack.counters import new_counters
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.line import Line
from wsn_tracking.zstack.port import open_port
from wsn_tracking.zstack.protocols import LineProtocol
from wsn_tracking.zstack.settings import LinkConfig
from wsn_tracking.zstack.startup import attach, network_info, probe

TURN_S = 1.0


def listen(config: LinkConfig, protocol: LineProtocol, seconds: float | None, *, questions: bool) -> None:
    """Open the port, with `questions` ask what the sink is, else attach to it, and listen (None: until interrupted)."""
    port = open_port(config.port, config.baud, config.timeout.reply, rtscts=config.rtscts)
    with contextlib.closing(port):
        line = Line(port, protocol, config.timeout.gap)
        dialogue = Dialogue(line, config.timeout, new_counters())
        time.sleep(config.timeout.settle)
        line.drop()
        is_new = config.sink_protocol == 'znp'
        end = float('inf')
        while time.monotonic() < end:
            if is_new:
                dialogue.restarted = False
                _introduce(dialogue, config, questions=questions)
            elif end == float('inf') and seconds is not None:
                end = time.monotonic() + seconds
            else:
                dialogue.listen(min(end, time.monotonic() + TURN_S))
            is_new = dialogue.restarted and config.sink_protocol == 'znp'


def _introduce(dialogue: Dialogue, config: LinkConfig, *, questions: bool) -> None:
    """Say what is said to a new sink; one that restarts meanwhile is new again, and no error."""
    try:
        _ask_or_attach(dialogue, config, questions=questions)
    except TrackingError:
        if not dialogue.restarted:
            raise


def _ask_or_attach(dialogue: Dialogue, config: LinkConfig, *, questions: bool) -> None:
    sink = probe(dialogue, toggle_dtr_rts=config.toggle_dtr_rts)
    if not questions:
        attach(dialogue, config.radio, config.multicast_group)
    elif sink.device is not None and sink.device.state == COORDINATOR_UP:  # a network that is down is not started
        network_info(dialogue)
        radio = config.radio
        with contextlib.suppress(TrackingError):
            dialogue.ask(ZdoMgmtLqiReq(0, 0), ZdoMgmtLqiReqRsp)
        with contextlib.suppress(TrackingError):
            dialogue.ask(AfRegister(radio.endpoint, radio.profile, in_clusters=(radio.cluster,)), AfRegisterRsp)
