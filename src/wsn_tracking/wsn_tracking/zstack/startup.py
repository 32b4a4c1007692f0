"""What is said to a sink before it delivers: probe, attach, and, only when asked for, form (zstack.md, section 4)."""

from __future__ import annotations

import time
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import (
    ALREADY_REGISTERED,
    COORDINATOR_UP,
    AfRegister,
    AfRegisterRsp,
    SysPing,
    SysPingRsp,
    SysVersion,
    SysVersionRsp,
    UtilGetDeviceInfo,
    UtilGetDeviceInfoRsp,
    ZdoExtAddGroup,
    ZdoExtAddGroupRsp,
    ZdoExtNwkInfo,
    ZdoExtNwkInfoRsp,
    ZdoStartup,
    ZdoStartupRsp,
)
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.protocols import Radio

WAKE = b'\xef' * 256  # fills up whatever the sink's parser waits for, and leaves the serial boot loader
STARTUP_FAILED = 2


class Sink(NamedTuple):
    """What a sink says of itself; None where it does not say."""

    capabilities: int
    version: SysVersionRsp | None
    device: UtilGetDeviceInfoRsp | None


def ping(dialogue: Dialogue) -> SysPingRsp:
    """One ping; TrackingError if there is no answer."""
    return dialogue.ask(SysPing(), SysPingRsp, dialogue.timeout.ping)


def probe(dialogue: Dialogue, *, toggle_dtr_rts: bool = False) -> Sink:
    """Find out what is there, waking it where it does not answer."""
    for wake in (None, _wake, _toggle if toggle_dtr_rts else None):
        if wake is not None:
            wake(dialogue)
        try:
            capabilities = ping(dialogue).capabilities
        except TrackingError:
            continue
        return Sink(capabilities, _version(dialogue), device_info(dialogue))
    raise TrackingError(
        f'nothing answers at {dialogue.line.port.name}: expected a CC2530 with Z-Stack (sink_protocol znp); '
        'check power, baud and rtscts, or name the sink_protocol it speaks'
    )


def _wake(dialogue: Dialogue) -> None:
    dialogue.line.port.write(WAKE)
    dialogue.pause(dialogue.timeout.wake)


def _toggle(dialogue: Dialogue) -> None:
    dialogue.line.port.toggle()
    dialogue.pause(dialogue.timeout.wake)


def _version(dialogue: Dialogue) -> SysVersionRsp | None:
    try:
        return dialogue.ask(SysVersion(), SysVersionRsp, tries=dialogue.timeout.tries)
    except TrackingError:
        return None


def device_info(dialogue: Dialogue) -> UtilGetDeviceInfoRsp | None:
    """Address and state of the sink; None if it does not say."""
    try:
        return dialogue.ask(UtilGetDeviceInfo(), UtilGetDeviceInfoRsp, tries=dialogue.timeout.tries)
    except TrackingError:
        return None


def network_info(dialogue: Dialogue) -> ZdoExtNwkInfoRsp | None:
    """The network; None if the sink does not say, as some do not."""
    try:
        return dialogue.ask(ZdoExtNwkInfo(), ZdoExtNwkInfoRsp)
    except TrackingError:
        return None


def attach(dialogue: Dialogue, radio: Radio, multicast_group: int = 0) -> ZdoExtNwkInfoRsp | None:
    """Start the network the sink remembers and have our messages passed on; writes nothing to the sink's memory."""
    device = device_info(dialogue)
    if device is None or device.state != COORDINATOR_UP:
        start(dialogue)
    register(dialogue, radio, dialogue.timeout.tries)
    if multicast_group:
        group = ZdoExtAddGroup(radio.endpoint, multicast_group)
        status = dialogue.ask(group, ZdoExtAddGroupRsp, tries=dialogue.timeout.tries).status
        if status != 0:
            raise TrackingError(f'the sink refuses multicast group {multicast_group:#06x} (status {status:#04x})')
    return network_info(dialogue)


def register(dialogue: Dialogue, radio: Radio, tries: int = 1) -> bool:
    """Have our messages passed on; whether the sink did not do so before."""
    question = AfRegister(radio.endpoint, radio.profile, in_clusters=(radio.cluster,))
    status = dialogue.ask(question, AfRegisterRsp, tries=tries).status
    if status != 0 and status not in ALREADY_REGISTERED:
        raise TrackingError(f'the sink refuses to register endpoint {radio.endpoint:#04x} (status {status:#04x})')
    return status == 0


def start(dialogue: Dialogue) -> None:
    """Start the network; TrackingError if it does not come up."""
    dialogue.state = None
    try:
        status = dialogue.ask(ZdoStartup(), ZdoStartupRsp, dialogue.timeout.startup).status
    except TrackingError:
        if _is_up(dialogue):  # its answer was lost
            return
        raise
    if status == STARTUP_FAILED:
        raise TrackingError('the sink cannot start its network (status 2): form one, see docs, or reset the sink')
    await_coordinator(dialogue)


def await_coordinator(dialogue: Dialogue) -> None:
    """Wait until the network is up; a sink that is silent about it is asked now and then."""
    timeout, before = dialogue.timeout, dialogue.counters['resets']
    end = time.monotonic() + timeout.commissioning
    state: int | None = None
    while not dialogue.until(
        lambda: _is_up(dialogue) or dialogue.counters['resets'] > before,
        min(timeout.reply, max(end - time.monotonic(), 0.0)),
    ):
        device = device_info(dialogue)
        state = None if device is None else device.state
        if state == COORDINATOR_UP:
            return
        if time.monotonic() >= end:
            words = 'unknown' if state is None else state
            raise TrackingError(f'the network of the sink does not come up (state {words}, {COORDINATOR_UP} expected)')
    if not _is_up(dialogue):
        raise TrackingError('the sink restarted while its network came up')


def _is_up(dialogue: Dialogue) -> bool:
    """Whether the sink has said so."""
    return dialogue.state == COORDINATOR_UP
