"""The faults by name, and how one is written: `name` or `name=value`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.faults import on_air, on_line, on_nodes, on_sink
from wsn_tracking.zstack.faults.base import Fault

SHARE, EPOCH, COUNT = 'share', 'epoch', 'count'


class Kind(NamedTuple):
    """What is known of a fault: `value` is a share of frames or messages, an epoch, or a count."""

    make: type[Fault]
    value: str
    default: float
    words: str


FAULTS = {
    'garbage': Kind(on_line.Garbage, SHARE, 0.1, 'random bytes between frames'),
    'boot_text': Kind(on_line.BootText, SHARE, 0.02, 'text at the plug and between frames'),
    'partial': Kind(on_line.Partial, SHARE, 0.2, 'frames in two pieces'),
    'cut': Kind(on_line.Cut, SHARE, 0.02, 'frames that are broken off'),
    'byte_at_a_time': Kind(on_line.ByteAtATime, SHARE, 1.0, 'every byte is written alone'),
    'batch': Kind(on_line.Batch, COUNT, 5, 'so many frames at once'),
    'bad_fcs': Kind(on_line.BadFcs, SHARE, 0.05, 'frames with a wrong check'),
    'long_len': Kind(on_line.LongLength, SHARE, 0.05, 'beginnings of frames with LEN > 250'),
    'corrupted_len': Kind(on_line.CorruptedLength, SHARE, 0.05, 'frames with another LEN'),
    'reset': Kind(on_sink.Reset, EPOCH, 10, 'the sink restarts'),
    'unplug': Kind(on_sink.Unplug, EPOCH, 10, 'the sink is unplugged, and comes back under another name'),
    'mute': Kind(on_sink.Mute, EPOCH, 10, 'the sink is silent and deaf for a while'),
    'stale': Kind(on_sink.Stale, SHARE, 1.0, 'old input lies in the port when it appears'),
    'duplicates': Kind(on_air.Duplicates, SHARE, 0.2, 'messages that are repeated'),
    'relayed': Kind(on_air.Relayed, SHARE, 0.2, 'broadcasts that come by two ways'),
    'reorder': Kind(on_air.Reorder, SHARE, 0.1, 'messages that are overtaken by the next'),
    'lost': Kind(on_air.Lost, SHARE, 0.1, 'messages that never come'),
    'wraps': Kind(
        on_nodes.Wraps, COUNT, 5, 'numbers, node clocks and sink clock wrap after so many messages, or seconds'
    ),
    'reboot': Kind(on_nodes.Reboot, EPOCH, 10, 'nodes restart'),
    'rejoin': Kind(on_nodes.Rejoin, EPOCH, 10, 'nodes come back under other addresses'),
    'two_addresses': Kind(on_air.TwoAddresses, SHARE, 0.2, 'nodes whose id a second radio bears'),
    'rpc_error': Kind(on_sink.RpcErrors, SHARE, 0.1, 'requests that are refused'),
    'no_network_info': Kind(on_sink.NoNetworkInfo, SHARE, 1.0, 'ZDO_EXT_NWK_INFO is refused'),
    'missing_reply': Kind(on_sink.MissingReply, SHARE, 0.1, 'answers that are lost'),
    'late_reply': Kind(on_sink.LateReply, SHARE, 0.1, 'answers that come too late'),
    'payload_crc': Kind(on_air.PayloadCrc, SHARE, 0.05, 'payloads that are damaged'),
    'unknown_version': Kind(on_air.UnknownVersion, SHARE, 0.1, 'messages of another version as well'),
    'foreign_cluster': Kind(on_air.ForeignCluster, SHARE, 0.1, 'messages of another cluster as well'),
    'foreign_endpoint': Kind(on_air.ForeignEndpoint, SHARE, 0.1, 'messages to another endpoint as well'),
}


def parse_faults(texts: Iterable[str], seconds: float, seed: int) -> list[Fault]:
    """The faults that are written; in the order in which they act. TrackingError for what is none."""
    faults = [_parse(text, seconds, seed + k) for k, text in enumerate(filter(None, texts))]
    return sorted(faults, key=lambda fault: fault.stage)


def _parse(text: str, seconds: float, seed: int) -> Fault:
    name, equals, value = text.partition('=')
    kind = FAULTS.get(name)
    if kind is None:
        raise TrackingError(f'there is no fault `{name}`: expected one of {", ".join(FAULTS)}')
    if not equals:
        return kind.make(kind.default, seconds, seed)
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    whole = kind.value == SHARE or number == math.floor(number if math.isfinite(number) else 0.5)
    if not (0.0 <= number <= (1.0 if kind.value == SHARE else 1e6) and whole):
        wanted = 'a share from 0 to 1' if kind.value == SHARE else 'a whole number, 0 or more'
        raise TrackingError(f'fault {text!r} ({kind.words}): expected {name}={wanted}')
    return kind.make(number, seconds, seed)
