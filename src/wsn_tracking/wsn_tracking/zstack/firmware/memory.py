"""The non-volatile memory of a sink, as TI's SYS_OSAL_NV commands see it (MT_SYS.c)."""

from __future__ import annotations

from wsn_tracking.zstack.firmware.flavour import Flavour
from wsn_tracking.zstack.firmware.items import GUARDED, SETTINGS, Item
from wsn_tracking.zstack.firmware.nib import NO_NETWORK, Network, pack_nib, unpack_nib

MAX_READ = 246  # bytes of an item that one answer holds
MAX_ITEM = 2048

SUCCESS, INVALID_PARAMETER, CREATED, WRONG_LENGTH = 0x00, 0x02, 0x09, 0x0C
CLEAR_CONFIG, CLEAR_STATE = 1, 2  # bits of STARTUP_OPTION
FIRST_COUNTER = 2500  # of frames that a new network has secured
EMPTY_ADDRESS = b'\x00' + b'\xff' * 10


class Memory:
    """Items and their bytes; survives resets."""

    def __init__(self, flavour: Flavour, ieee: int) -> None:
        self._flavour = flavour
        self._ieee = ieee
        self._items: dict[int, bytes] = {}
        self._default_settings()
        self._forget_network()

    def get(self, item: int, default: bytes = b'') -> bytes:
        """What an item holds, for the firmware itself."""
        return self._items.get(item, default)

    def put(self, item: int, value: bytes) -> None:
        """Store an item, for the firmware itself."""
        self._items[item] = value

    @property
    def content(self) -> dict[int, bytes]:
        """All items."""
        return dict(self._items)

    @property
    def ieee(self) -> int:
        """The address of the radio."""
        return int.from_bytes(self.get(Item.EXTADDR), 'little')

    @property
    def network(self) -> Network:
        """The network that is remembered, or NO_NETWORK."""
        if self._flavour.has_bdb and self.get(Item.ON_A_NETWORK) != b'\x01':
            return NO_NETWORK
        return unpack_nib(self.get(Item.NIB))

    def boot(self) -> None:
        """What a start does: clear what STARTUP_OPTION says, restore the radio's own address."""
        option = self.get(Item.STARTUP_OPTION, b'\x00')[0]
        if option & CLEAR_CONFIG:
            self._default_settings()
        if option & CLEAR_STATE:
            self._forget_network()
        self.put(Item.STARTUP_OPTION, b'\x00')
        if len(self.get(Item.EXTADDR)) != 8:
            self.put(Item.EXTADDR, self._ieee.to_bytes(8, 'little'))
        if not self._flavour.has_bdb and not self.get(Item.NIB):
            self.put(Item.NIB, pack_nib(NO_NETWORK))

    def remember(self, network: Network) -> None:
        """Store a network that was formed, and its key."""
        key = (self.get(Item.KEY) + bytes(16))[:16]
        ext_pan = network.ext_pan.to_bytes(8, 'little')
        self.put(Item.NIB, pack_nib(network))
        self.put(Item.EXTENDED_PAN_ID, ext_pan)
        self.put(Item.ACTIVE_KEY, b'\x00' + key)
        self.put(Item.ALTERNATE_KEY, b'\x00' + key)
        counter = FIRST_COUNTER.to_bytes(4, 'little')
        self.put(Item.NETWORK_KEY, b'\x00' + key + counter)
        if self._flavour.has_bdb:
            self.put(Item.ON_A_NETWORK, b'\x01')
            self.put(Item.SECURITY_MATERIAL, counter + ext_pan)

    # ---- what hosts do

    def length(self, item: int) -> int:
        """Bytes of an item; 0 where there is none."""
        return len(self.get(item))

    def read(self, item: int, offset: int, *, guarded: bool = True) -> tuple[int, bytes]:
        """Status, and the bytes from `offset` on; `guarded`: keys are not told."""
        if item == Item.OLD_POLL_RATE:
            return SUCCESS, self.get(Item.POLL_RATE)[:2]
        value = self.get(item)
        if offset >= len(value) or (guarded and self._flavour.guards_keys and item in GUARDED):
            return INVALID_PARAMETER, b''
        return SUCCESS, value[offset : offset + MAX_READ]

    def write(self, item: int, offset: int, data: bytes) -> int:
        """Status of writing into an item that exists and is long enough."""
        item = Item.POLL_RATE if item == Item.OLD_POLL_RATE else item
        value = self.get(item)
        if not value or offset + len(data) > len(value):
            return INVALID_PARAMETER
        self.put(item, value[:offset] + data + value[offset + len(data) :])
        return SUCCESS

    def create(self, item: int, length: int, data: bytes) -> int:
        """Status of creating an item; one that exists is left as it is."""
        if self.get(item) or item == Item.OLD_POLL_RATE:
            return SUCCESS
        if not 0 < length <= MAX_ITEM:
            return INVALID_PARAMETER
        self.put(item, data[:length].ljust(length, b'\xff'))
        return CREATED

    def delete(self, item: int, length: int) -> int:
        """Status of deleting an item of that length."""
        if item == Item.OLD_POLL_RATE:
            return SUCCESS
        if not self.get(item):
            return CREATED
        if len(self.get(item)) != length:
            return WRONG_LENGTH
        del self._items[item]
        return SUCCESS

    # ---- within

    def _default_settings(self) -> None:
        self._items.update({item: bytes.fromhex(value) for item, value in SETTINGS.items()})
        self.put(Item.EXTADDR, self._ieee.to_bytes(8, 'little'))
        self.put(Item.STARTUP_OPTION, b'\x00')
        self.put(Item.USE_EXT_PAN_ID, bytes(8))
        self.put(Item.KEY, bytes(16))
        self.put(0x0063, b'\x00')  # the key is not given to others in advance
        self.put(Item.PAN_ID, b'\xff\xff')
        self.put(Item.CHANNELS, (1 << 11).to_bytes(4, 'little'))
        self.put(Item.LOGICAL_TYPE, b'\x00')
        self.put(Item.DIRECT_CALLBACKS, b'\x00')

    def _forget_network(self) -> None:
        self.put(Item.NIB, pack_nib(NO_NETWORK))
        self.put(Item.EXTENDED_PAN_ID, bytes(8))
        self.put(Item.ACTIVE_KEY, bytes(17))
        self.put(Item.ALTERNATE_KEY, bytes(17))
        self.put(Item.NETWORK_KEY, bytes(21))
        self.put(Item.LINK_KEYS, bytes(17))
        if self._flavour.has_bdb:
            del self._items[Item.NIB]  # is made when a network is formed
            self.put(Item.ADDRMGR, EMPTY_ADDRESS * 62)
            self.put(Item.ON_A_NETWORK, b'\x00')
            self.put(Item.SECURITY_MATERIAL, bytes(12))
            self.put(Item.SECURITY_GLOBAL, b'\xff' * 12)
            self.put(Item.TRUST_CENTRE, bytes(range(16)))
        else:
            self.put(Item.ADDRMGR, EMPTY_ADDRESS * 23)
            self.put(Item.TRUST_CENTRE, b'\xff' * 8 + b'ZigBeeAlliance09' + bytes(8))
