"""The items of a sink's memory by number, and what they hold at first (ZComDef.h)."""

from __future__ import annotations

from enum import IntEnum


class Item(IntEnum):
    """The items that mean something to this simulation."""

    EXTADDR = 0x0001
    STARTUP_OPTION = 0x0003
    NIB = 0x0021
    ADDRMGR = 0x0023
    EXTENDED_PAN_ID = 0x002D
    ACTIVE_KEY = 0x003A
    ALTERNATE_KEY = 0x003B
    USE_EXT_PAN_ID = 0x0047
    LINK_KEYS = 0x004C
    ON_A_NETWORK = 0x0055
    OLD_POLL_RATE = 0x0024  # is none: it stands for the lower half of the one that took its place
    POLL_RATE = 0x0035
    SECURITY_LEVEL = 0x0061
    KEY = 0x0062  # with which networks are formed
    SECURITY_MATERIAL = 0x0075
    SECURITY_GLOBAL = 0x0076
    NETWORK_KEY = 0x0082
    PAN_ID = 0x0083
    CHANNELS = 0x0084
    LOGICAL_TYPE = 0x0087
    DIRECT_CALLBACKS = 0x008F
    TRUST_CENTRE = 0x0101  # Home 1.2: its link key; 3.0: the seed of link keys


GUARDED = frozenset({Item.ACTIVE_KEY, Item.ALTERNATE_KEY, Item.KEY, *range(0x0101, 0x0300)})
# What hosts look at and this simulation does not use: value by item, little endian.
SETTINGS = {
    0x0004: '0a',  # start delay
    0x0025: '6400',  # poll rates
    0x0026: '6400',
    0x0027: 'b801',
    0x0028: '02',  # retries
    0x0029: '02',
    0x002A: '02',  # stack profile: PRO
    0x002B: '07',
    0x002C: '1e',  # expiry of routes
    0x002E: '02',  # broadcasts
    0x002F: '05',
    0x0030: '14',
    0x0031: '02',  # mesh
    0x0032: '01',  # concentrator
    0x0033: '3c',
    0x0034: '0a',
    0x0035: 'e8030000',
    0x0036: '00',
    0x0037: '01',
    0x0038: '0a',  # expiry of source routes
    0x0039: '05',
    0x003C: '00',
    0x003D: '01',
    0x003E: '00',  # ageing of children
    0x0043: '03',  # APS
    0x0044: 'b80b',
    0x0045: '02',
    0x0046: '803e',
    0x0048: '01',
    0x0049: 'feff',
    0x004B: '02',
    0x0051: '00',
    0x0052: '08',
    0x0061: '05',  # security level
    0x0064: '04',  # security mode
    0x0065: '01',
    0x006D: '00',
    0x006F: '01',
    0x0071: '0000000000000000',  # trust centre
    0x0081: '00' * 17,  # user descriptor
    0x0086: '05',
    0x0088: '14',
    0x00A1: 'e0',
}
