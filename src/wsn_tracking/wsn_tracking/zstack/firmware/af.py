"""AF: endpoints, and messages to the nodes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from wsn_tracking.zstack.commands import AfDataConfirm, AfRegister, encode
from wsn_tracking.zstack.firmware.chip import BROADCAST, UP, Chip, Sent
from wsn_tracking.zstack.firmware.memory import INVALID_PARAMETER, SUCCESS
from wsn_tracking.zstack.firmware.nib import UNKNOWN_ADDRESS
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.firmware.zdp import loop_back
from wsn_tracking.zstack.frames import Frame

AF = Table()
MAX_ENDPOINT = 254
NWK_INVALID_REQUEST, NWK_NO_ROUTE = 0xC2, 0xCD
CONFIRM_S = 0.01
GROUP, SHORT, IEEE, TO_ALL = 1, 2, 3, 15  # address modes


class Request(NamedTuple):
    """A message that is to be sent, whichever command asks for it."""

    dst: int
    dst_endpoint: int
    src_endpoint: int
    cluster: int
    trans_id: int
    data: bytes


@AF.on(0x2400, 'BHHBB*H*H')
def register(chip: Chip, endpoint: int, *rest: int) -> Iterable[Frame]:
    """AF_REGISTER: kept in RAM."""
    if not 0 < endpoint <= MAX_ENDPOINT:
        return [srsp(0x2400, INVALID_PARAMETER)]
    if endpoint in chip.endpoints:
        return [srsp(0x2400, chip.flavour.already_registered)]
    chip.endpoints[endpoint] = AfRegister._make((endpoint, *rest))
    return [srsp(0x2400, SUCCESS)]


@AF.on(0x2404, 'B')
def delete(chip: Chip, endpoint: int) -> Iterable[Frame]:
    """AF_DELETE."""
    known = chip.endpoints.pop(endpoint, None)
    return [srsp(0x2404, INVALID_PARAMETER if known is None else SUCCESS)]


@AF.on(0x2401, 'HBBHBBB*B')
def send(
    chip: Chip, dst: int, to: int, by: int, cluster: int, number: int, options: int, radius: int, data: bytes
) -> Iterable[Frame]:
    """AF_DATA_REQUEST."""
    return _send(chip, 0x2401, Request(dst, to, by, cluster, number, data))


@AF.on(0x2402, 'BQBHBHBBBH$')
def send_ext(
    chip: Chip,
    mode: int,
    address: int,
    to: int,
    pan_id: int,
    by: int,
    cluster: int,
    number: int,
    options: int,
    radius: int,
    length: int,
    data: bytes,
) -> Iterable[Frame]:
    """AF_DATA_REQUEST_EXT: wider addresses."""
    dst = address & 0xFFFF
    if mode == IEEE:
        dst = next((mote.short for mote in chip.motes.values() if mote.ieee == address), UNKNOWN_ADDRESS)
    if mode == GROUP:
        dst = 0xFFFF
    if len(data) < length or mode not in (GROUP, SHORT, IEEE, TO_ALL):
        return [srsp(0x2402, INVALID_PARAMETER)]
    return _send(chip, 0x2402, Request(dst, to, by, cluster, number, data[:length]))


@AF.on(0x2403, 'HBBHBBB*H*B')
def send_by_route(
    chip: Chip,
    dst: int,
    to: int,
    by: int,
    cluster: int,
    number: int,
    options: int,
    radius: int,
    relays: tuple[int, ...],
    data: bytes,
) -> Iterable[Frame]:
    """AF_DATA_REQUEST_SRC_RTG."""
    return _send(chip, 0x2403, Request(dst, to, by, cluster, number, data))


@AF.on(0x2410, 'B$')
def inter_pan(chip: Chip, command: int, data: bytes) -> Iterable[Frame]:
    """AF_INTER_PAN_CTL: accepted; there are no other networks here."""
    return [srsp(0x2410, SUCCESS)]


def _send(chip: Chip, header: int, request: Request) -> list[Frame]:
    if chip.state != UP:
        return [srsp(header, NWK_INVALID_REQUEST)]
    if request.src_endpoint not in chip.endpoints and request.src_endpoint != 0:
        return [srsp(header, INVALID_PARAMETER)]
    if request.dst_endpoint == 0:  # a ZDO message that the host has made itself
        chip.later(CONFIRM_S, lambda: loop_back(chip, request.dst, request.cluster, request.data))
        return [srsp(header, SUCCESS)]
    reached = (request.dst >= BROADCAST and request.dst != UNKNOWN_ADDRESS) or request.dst in chip.motes
    status = SUCCESS if reached else NWK_NO_ROUTE
    if reached:
        chip.sent.append(Sent(chip.now, request.dst, request.dst_endpoint, request.cluster, request.data))
        chip.counters['messages_sent'] += 1
    confirm = encode(AfDataConfirm(status, request.src_endpoint, request.trans_id))
    chip.later(CONFIRM_S, lambda: [confirm])
    return [srsp(header, SUCCESS)]
