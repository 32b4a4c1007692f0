"""The ZigBee device profile: what the sink and its motes say of themselves, as it goes over the air.

An answer comes to the host as the MT command of its own, and, where the host has asked for that
(ZDO_MSG_CB_REGISTER), as the message that it is.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from wsn_tracking.zstack.commands import AfRegister
from wsn_tracking.zstack.firmware.chip import BROADCAST, Chip, Mote
from wsn_tracking.zstack.frames import Frame

NOT_ACTIVE, NO_SUCH_DEVICE = 0x82, 0x81
ALL = 0xFFFF  # every cluster
ANSWER = 0x8000  # added to a cluster
MESSAGE = 0x45FF  # ZDO_MSG_CB_INCOMING
NWK_ADDR, IEEE_ADDR, NODE_DESC, POWER_DESC, SIMPLE_DESC, ACTIVE_EP, MATCH_DESC = range(7)
MGMT_LQI, MGMT_RTG, MGMT_BIND, MGMT_PERMIT, NWK_UPDATE = 0x31, 0x32, 0x33, 0x36, 0x38
BIND, UNBIND = 0x21, 0x22
COORDINATOR_NODE = bytes((0x00, 0x40, 0x8F, 0, 0, 80, 160, 0, 1, 0, 160, 0, 0))
ROUTER_NODE = bytes((0x01,)) + b'\x40\x8e' + COORDINATOR_NODE[3:]
MAINS = b'\x10\xc1'
MOTE_ENDPOINT = AfRegister(0xE8, 0xBF01, in_clusters=(0x10,), out_clusters=(0x10,))
PER_ANSWER = 2  # neighbours of which one answer tells
UNKNOWN_JOIN = 2
LONGEST_SCAN = 5  # durations above it are commands
QUIET = 20  # energy that a scan finds

Answerer = Callable[[Chip, Mote, bytes], bytes]


def sink_mote(chip: Chip) -> Mote:
    """The sink as one of the radios."""
    return Mote(chip.network.short, chip.memory.ieee)


def ask(chip: Chip, dst: int, cluster: int, body: bytes, number: int = 0) -> list[Frame]:
    """What a request over the air leads to; nothing where nobody is asked who could answer."""
    answerer = ANSWERERS.get(cluster)
    if answerer is None:
        return []
    sink = sink_mote(chip)
    if cluster in (NWK_ADDR, IEEE_ADDR):
        mote: Mote | None = sink  # knows, or asks, everybody
    else:
        mote = sink if dst == sink.short or dst >= BROADCAST else chip.motes.get(dst)
    if mote is None:
        return []
    try:
        answer = answerer(chip, mote, body)
    except (struct.error, IndexError):
        return []
    return _told(chip, mote, cluster, answer, number) if answer else []


def loop_back(chip: Chip, dst: int, cluster: int, data: bytes) -> list[Frame]:
    """As `ask`, for a message that begins with its number."""
    return ask(chip, dst, cluster, data[1:], data[0]) if data else []


def _told(chip: Chip, mote: Mote, cluster: int, answer: bytes, number: int) -> list[Frame]:
    header = 0x4580 | cluster & 0x7F
    src = mote.short.to_bytes(2, 'little')
    if cluster in (NWK_ADDR, IEEE_ADDR):
        frames = [Frame(header, answer.ljust(13, b'\x00'))]  # MT always tells where its list of children starts
    else:
        frames = [Frame(header, src + answer)]
    if ALL in chip.callbacks or cluster | ANSWER in chip.callbacks:
        body = struct.pack('<HBHBBH', mote.short, 0, cluster | ANSWER, 0, number, 0)
        frames.append(Frame(MESSAGE, body + answer))
    return frames


# ---- the answers, each from its status on


def _address(chip: Chip, mote: Mote) -> bytes:
    return struct.pack('<BQH', 0, mote.ieee, mote.short)


def _nwk_addr(chip: Chip, mote: Mote, body: bytes) -> bytes:
    (ieee,) = struct.unpack_from('<Q', body)
    found = [m for m in (mote, *chip.motes.values()) if m.ieee == ieee]
    return _address(chip, found[0]) if found else b''


def _ieee_addr(chip: Chip, mote: Mote, body: bytes) -> bytes:
    (short,) = struct.unpack_from('<H', body)
    found = [m for m in (mote, *chip.motes.values()) if m.short == short]
    return _address(chip, found[0]) if found else b''


def _of_interest(mote: Mote, body: bytes) -> tuple[bytes, bool]:
    """The address that is asked about, and whether that is the radio itself."""
    (short,) = struct.unpack_from('<H', body)
    return body[:2], short == mote.short


def _node_desc(chip: Chip, mote: Mote, body: bytes) -> bytes:
    address, own = _of_interest(mote, body)
    if not own:
        return bytes((NO_SUCH_DEVICE,)) + address
    return b'\x00' + address + (COORDINATOR_NODE if mote.short == 0 else ROUTER_NODE)


def _power_desc(chip: Chip, mote: Mote, body: bytes) -> bytes:
    address, own = _of_interest(mote, body)
    return b'\x00' + address + MAINS if own else bytes((NO_SUCH_DEVICE,)) + address


def _endpoints(chip: Chip, mote: Mote) -> dict[int, AfRegister]:
    return chip.endpoints if mote.short == 0 else {MOTE_ENDPOINT.endpoint: MOTE_ENDPOINT}


def _active_ep(chip: Chip, mote: Mote, body: bytes) -> bytes:
    address, own = _of_interest(mote, body)
    active = bytes(sorted(_endpoints(chip, mote), reverse=True)) if own else b''
    return bytes((0 if own else NO_SUCH_DEVICE,)) + address + bytes((len(active),)) + active


def _simple_desc(chip: Chip, mote: Mote, body: bytes) -> bytes:
    address, own = _of_interest(mote, body)
    endpoint = _endpoints(chip, mote).get(body[2])
    if endpoint is None or not own:
        return bytes((NOT_ACTIVE if own else NO_SUCH_DEVICE,)) + address + b'\x00'
    head = struct.pack('<BHHB', endpoint.endpoint, endpoint.profile, endpoint.device, endpoint.version)
    clusters = _clusters(endpoint.in_clusters) + _clusters(endpoint.out_clusters)
    descriptor = head + clusters
    return b'\x00' + address + bytes((len(descriptor),)) + descriptor


def _clusters(clusters: tuple[int, ...]) -> bytes:
    return bytes((len(clusters),)) + struct.pack(f'<{len(clusters)}H', *clusters)


def _match_desc(chip: Chip, mote: Mote, body: bytes) -> bytes:
    address, own = _of_interest(mote, body)
    (profile,) = struct.unpack_from('<H', body, 2)
    endpoints = _endpoints(chip, mote).values() if own else ()
    found = bytes(endpoint.endpoint for endpoint in endpoints if endpoint.profile == profile)
    return b'\x00' + address + bytes((len(found),)) + found


def _lqi(chip: Chip, mote: Mote, body: bytes) -> bytes:
    start = body[0]
    others = sorted(chip.motes.values()) if mote.short == 0 else [sink_mote(chip)]
    part = others[start : start + PER_ANSWER]
    head = bytes((0, len(others) & 0xFF, start, len(part)))
    return head + b''.join(_neighbour(chip, other) for other in part)


def _neighbour(chip: Chip, mote: Mote) -> bytes:
    kind = 0 if mote.short == 0 else 1 if mote.router else 2
    bits = kind | 0x04 | (0x10 if mote.short else 0)  # its receiver is on; a child, or a parent
    ext_pan = chip.network.ext_pan
    return struct.pack('<QQHBBBB', ext_pan, mote.ieee, mote.short, bits, UNKNOWN_JOIN, min(kind, 1), mote.lqi)


def _empty_table(chip: Chip, mote: Mote, body: bytes) -> bytes:
    return bytes((0, 0, body[0], 0))


def _scan(chip: Chip, mote: Mote, body: bytes) -> bytes:
    """A scan of the energy on channels; a change of channel has no answer."""
    mask, duration = struct.unpack_from('<IB', body)
    if duration > LONGEST_SCAN:
        return b''
    channels = int(mask).bit_count()
    return struct.pack('<BIHHB', 0, mask, 0, 0, channels) + bytes((QUIET,)) * channels


def _done(chip: Chip, mote: Mote, body: bytes) -> bytes:
    return b'\x00'


ANSWERERS: dict[int, Answerer] = {
    NWK_ADDR: _nwk_addr,
    IEEE_ADDR: _ieee_addr,
    NODE_DESC: _node_desc,
    POWER_DESC: _power_desc,
    SIMPLE_DESC: _simple_desc,
    ACTIVE_EP: _active_ep,
    MATCH_DESC: _match_desc,
    BIND: _done,
    UNBIND: _done,
    MGMT_LQI: _lqi,
    MGMT_RTG: _empty_table,
    MGMT_BIND: _empty_table,
    MGMT_PERMIT: _done,
    NWK_UPDATE: _scan,
}
