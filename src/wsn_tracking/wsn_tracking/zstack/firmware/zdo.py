"""ZDO: starting the network, what the sink and its motes say of themselves, groups and routes."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from wsn_tracking.zstack.commands import ZdoExtNwkInfoRsp, encode
from wsn_tracking.zstack.firmware.chip import UP, Chip
from wsn_tracking.zstack.firmware.memory import SUCCESS
from wsn_tracking.zstack.firmware.nib import NO_NETWORK
from wsn_tracking.zstack.firmware.table import Table, srsp
from wsn_tracking.zstack.firmware.zdp import ALL, ANSWERERS, IEEE_ADDR, MGMT_PERMIT, NWK_ADDR, NWK_UPDATE, ask
from wsn_tracking.zstack.frames import Frame

ZDO = Table()
FAILURE, NWK_INVALID_REQUEST = 0x01, 0xC2
RESTORED, NEW_NETWORK = 0, 1
PERMIT_JOIN_IND = 0x45CB
DISCOVERED = 0x45C7  # ZDO_NWK_DISCOVERY_CNF
ANSWER_S = 0.005  # until a radio has answered
AND_SINK = (0xFFFC, 0xFFFD, 0xFFFF)


@ZDO.on(0x2540, 'B$')
def start(chip: Chip, delay: int, more: bytes) -> Iterable[Frame]:
    """ZDO_STARTUP_FROM_APP: restores the network that is remembered, or forms one; some hosts say one byte."""
    if chip.state == UP or chip.memory.network is not NO_NETWORK:
        chip.restore()
        return [srsp(0x2540, RESTORED)]
    chip.form()
    return [srsp(0x2540, NEW_NETWORK)]


@ZDO.on(0x2550)
def network_info(chip: Chip) -> Iterable[Frame]:
    """ZDO_EXT_NWK_INFO."""
    network = chip.network
    return [
        encode(
            ZdoExtNwkInfoRsp(network.short, chip.state, network.pan_id, 0, network.ext_pan, 0, network.channel),
        )
    ]


def _asks(cluster: int, layout: str) -> Callable[..., Iterable[Frame]]:
    """The command that sends one request of the device profile; `layout` begins with whom to ask, where it says so."""
    header = 0x2500 | cluster

    def answer(chip: Chip, *fields: int | bytes) -> Iterable[Frame]:
        *_, rest = fields
        dst = fields[0] if len(fields) > 1 else 0
        assert isinstance(rest, bytes)
        assert isinstance(dst, int)
        if chip.state != UP:
            return [srsp(header, NWK_INVALID_REQUEST)]
        chip.later(ANSWER_S, lambda: ask(chip, dst, cluster, rest))
        return [srsp(header, SUCCESS)]

    ZDO.on(header, layout)(answer)
    return answer


for _cluster in ANSWERERS:
    if _cluster not in (MGMT_PERMIT, NWK_UPDATE):  # whose commands have other fields
        _asks(_cluster, '$' if _cluster in (NWK_ADDR, IEEE_ADDR) else 'H$')


@ZDO.on(0x2536, 'BHBB')
def permit_join(chip: Chip, mode: int, dst: int, seconds: int, significance: int) -> Iterable[Frame]:
    """ZDO_MGMT_PERMIT_JOIN_REQ: nobody wants to join, but it is told for how long they could."""

    def permitted() -> list[Frame]:
        told = [Frame(PERMIT_JOIN_IND, bytes((seconds,)))] if dst == 0 or dst in AND_SINK else []
        return [*told, *ask(chip, dst, MGMT_PERMIT, bytes((seconds, significance)))]

    chip.later(ANSWER_S, permitted)
    return [srsp(0x2536, SUCCESS)]


@ZDO.on(0x2537, 'HB$')
def update(chip: Chip, dst: int, mode: int, body: bytes) -> Iterable[Frame]:
    """ZDO_MGMT_NWK_UPDATE_REQ: its number is not that of its cluster."""
    chip.later(ANSWER_S, lambda: ask(chip, dst, NWK_UPDATE, body))
    return [srsp(0x2537, SUCCESS)]


@ZDO.on(0x2526, 'IB')
def discover_networks(chip: Chip, channels: int, duration: int) -> Iterable[Frame]:
    """ZDO_NETWORK_DISCOVERY_REQ: a sink without a network looks for others; there are none."""
    if chip.state == UP:
        return [srsp(0x2526, NWK_INVALID_REQUEST)]
    chip.later(ANSWER_S, lambda: [Frame(DISCOVERED, bytes((SUCCESS,)))])
    return [srsp(0x2526, SUCCESS)]


@ZDO.on(0x253E, 'H')
def register_callback(chip: Chip, cluster: int) -> Iterable[Frame]:
    """ZDO_MSG_CB_REGISTER."""
    chip.callbacks.add(cluster)
    return [srsp(0x253E, SUCCESS)]


@ZDO.on(0x253F, 'H')
def remove_callback(chip: Chip, cluster: int) -> Iterable[Frame]:
    """ZDO_MSG_CB_REMOVE."""
    if cluster == ALL:
        chip.callbacks.clear()
    chip.callbacks.discard(cluster)
    return [srsp(0x253F, SUCCESS)]


@ZDO.on(0x254A, 'BH')
def find_group(chip: Chip, endpoint: int, group: int) -> Iterable[Frame]:
    """ZDO_EXT_FIND_GROUP."""
    name = chip.groups.get((endpoint, group))
    if name is None:
        return [srsp(0x254A, FAILURE, bytes(3))]
    return [srsp(0x254A, SUCCESS, group.to_bytes(2, 'little'), len(name), name)]


@ZDO.on(0x254B, 'BH*B')
def add_group(chip: Chip, endpoint: int, group: int, name: bytes) -> Iterable[Frame]:
    """ZDO_EXT_ADD_GROUP."""
    if endpoint not in chip.endpoints or (endpoint, group) in chip.groups:
        return [srsp(0x254B, FAILURE)]
    chip.groups[endpoint, group] = name[:16]
    return [srsp(0x254B, SUCCESS)]


@ZDO.on(0x2547, 'BH')
def remove_group(chip: Chip, endpoint: int, group: int) -> Iterable[Frame]:
    """ZDO_EXT_REMOVE_GROUP."""
    known = chip.groups.pop((endpoint, group), None)
    return [srsp(0x2547, FAILURE if known is None else SUCCESS)]


@ZDO.on(0x2548, 'B')
def remove_groups(chip: Chip, endpoint: int) -> Iterable[Frame]:
    """ZDO_EXT_REMOVE_ALL_GROUP."""
    chip.groups = {key: name for key, name in chip.groups.items() if key[0] != endpoint}
    return [srsp(0x2548, SUCCESS)]


@ZDO.on(0x254C)
def count_groups(chip: Chip) -> Iterable[Frame]:
    """ZDO_EXT_COUNT_ALL_GROUPS."""
    return [srsp(0x254C, len(chip.groups) & 0xFF)]


@ZDO.on(0x2545, 'HBB')
def discover_route(chip: Chip, dst: int, options: int, radius: int) -> Iterable[Frame]:
    """ZDO_EXT_ROUTE_DISC."""
    return [srsp(0x2545, SUCCESS)]


@ZDO.on(0x2546, 'HBB')
def check_route(chip: Chip, dst: int, status: int, options: int) -> Iterable[Frame]:
    """ZDO_EXT_ROUTE_CHK."""
    return [srsp(0x2546, SUCCESS if dst in chip.motes else 4)]
