"""The network information base: the struct of 110 bytes in which a CC253x remembers its network.

Hosts read it to learn which network there is, and some write it. Little endian, no padding (nwk.h of TI's Z-Stack).
"""

from __future__ import annotations

import struct
from typing import NamedTuple

LENGTH = 110
HEAD = struct.Struct('<15BH3BHBHQHBI')  # up to the channel list
UNKNOWN_ADDRESS, UNKNOWN_PAN = 0xFFFE, 0xFFFF
ROUTER = 8  # state of a network layer that is up
CHANNELS = range(11, 27)

# Constants of the stack, in the order of the struct: counters, limits and the capability of a coordinator.
FIRST = (0, 5, 2, 20, 15, 20, 0, 20, 0, 0, 0, 1, 5, 1, 0x8F)
PERSISTENCE_TIME = 7
PROTOCOL = (2, 5, 30)
BEACONS = bytes((15, 15, 5, 0))  # no beacons; duration of scans
ADDRESSES = bytes((1, 0, 0, 0, 1, 0, 0, 0, 0))  # that were allocated; depth
KEYS = bytes(34)
LAST = bytes((0, 0, 15, 3, 0, 1, 60, 10, 1))  # link status every 15 s, source routing
MANAGER = bytes(5)


class Network(NamedTuple):
    """A network of which this radio is the coordinator."""

    channel: int  # 0: none
    pan_id: int
    ext_pan: int
    short: int = 0
    channels: int = 0  # mask of those that may be used


NO_NETWORK = Network(0, UNKNOWN_PAN, 0, UNKNOWN_ADDRESS)


def pack_nib(network: Network) -> bytes:
    """The struct; NO_NETWORK is that of a radio which has none."""
    up = network.channel in CHANNELS
    head = HEAD.pack(
        *FIRST,
        PERSISTENCE_TIME,
        *PROTOCOL,
        network.short,
        network.channel,
        0 if up else UNKNOWN_ADDRESS,
        0,
        network.pan_id,
        ROUTER if up else 0,
        network.channels,
    )
    rest = BEACONS + ADDRESSES + network.ext_pan.to_bytes(8, 'little') + bytes((up,)) + KEYS + LAST + MANAGER
    return head + rest


def unpack_nib(data: bytes) -> Network:
    """The network in the struct; NO_NETWORK where there is none, or the struct is not whole."""
    if len(data) != LENGTH:
        return NO_NETWORK
    *_, short, channel, _coordinator, _parent, pan_id, _state, channels = HEAD.unpack_from(data)
    at = HEAD.size + len(BEACONS) + len(ADDRESSES)
    key_loaded = data[at + 8]
    if channel not in CHANNELS or not key_loaded:
        return NO_NETWORK
    return Network(channel, pan_id, int.from_bytes(data[at : at + 8], 'little'), short, channels)
