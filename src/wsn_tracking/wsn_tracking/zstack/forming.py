"""Forming a new network, which erases the one the sink remembers and writes to its memory (zstack.md, section 4)."""

from __future__ import annotations

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import (
    COORDINATOR_UP,
    BdbSetChannel,
    BdbSetChannelRsp,
    BdbStartCommissioning,
    BdbStartCommissioningRsp,
    Nv,
    NvWrite,
    NvWriteRsp,
    SysResetReq,
)
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.settings import FormConfig
from wsn_tracking.zstack.startup import Sink, await_coordinator, network_info, start

CLEAR_ALL = b'\x03'  # configuration and network state, at the next start
COORDINATOR = b'\x00'


def is_formed(dialogue: Dialogue, sink: Sink, config: FormConfig) -> bool:
    """Whether the network is the one that is asked for: then there is nothing to form.

    A sink that has restarted tells nothing of the network that it remembers until that is started.
    """
    if sink.device is None or sink.device.state != COORDINATOR_UP:
        try:
            start(dialogue)
        except TrackingError:
            return False
    network = network_info(dialogue)
    return network is not None and (network.channel, network.pan_id) == (config.channel, config.pan_id)


def form(dialogue: Dialogue, sink: Sink, config: FormConfig) -> None:
    """Erase and form, where `check_confirmed` was content; TrackingError where the sink refuses."""
    mask = 1 << config.channel
    _write(dialogue, Nv.STARTUP_OPTION, CLEAR_ALL)
    _reset(dialogue)
    _write(dialogue, Nv.STARTUP_OPTION, b'\x00')
    _write(dialogue, Nv.LOGICAL_TYPE, COORDINATOR)
    _write(dialogue, Nv.ZDO_DIRECT_CB, b'\x01')
    _write(dialogue, Nv.CHANLIST, mask.to_bytes(4, 'little'))
    _write(dialogue, Nv.PANID, config.pan_id.to_bytes(2, 'little'))
    if sink.version is None or sink.version.product == 0:
        start(dialogue)
        return
    for question in (BdbSetChannel(1, mask), BdbSetChannel(0, 0)):
        _expect(dialogue.ask(question, BdbSetChannelRsp).status, 'the channel')
    dialogue.state = None
    _expect(dialogue.ask(BdbStartCommissioning(), BdbStartCommissioningRsp).status, 'to form a network')
    await_coordinator(dialogue)


def check_confirmed(sink: Sink, confirm: str) -> None:
    """TrackingError unless it is this sink whose network may be erased."""
    if sink.device is None:
        raise TrackingError('the sink does not tell its IEEE address: nothing is formed')
    try:
        confirmed = int(confirm, 16)
    except ValueError:
        confirmed = -1
    if confirmed != sink.device.ieee:
        raise TrackingError(
            f'forming erases the network of sink {sink.device.ieee:#018x}, the confirmation is {confirm!r}: '
            'to erase it, set form.confirm to that address'
        )


def _write(dialogue: Dialogue, item: Nv, value: bytes) -> None:
    answer = dialogue.ask(NvWrite(item, 0, value), NvWriteRsp, tries=dialogue.timeout.tries)
    _expect(answer.status, f'{item.name} = {value.hex()}')


def _expect(status: int, what: str) -> None:
    if status != 0:
        raise TrackingError(f'the sink refuses {what} (status {status:#04x}): its network may be erased, try again')


def _reset(dialogue: Dialogue) -> None:
    dialogue.restarted = False
    dialogue.line.say(SysResetReq())
    if not dialogue.until(lambda: dialogue.restarted, dialogue.timeout.reset):
        raise TrackingError('the sink does not come back from its reset: unplug it and plug it in again')
    dialogue.restarted = False  # it was asked for
