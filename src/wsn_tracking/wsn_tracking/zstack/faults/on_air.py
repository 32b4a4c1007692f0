"""Faults of the radio network: messages that come twice, late, damaged, from strangers, or not at all."""

from __future__ import annotations

from wsn_tracking.zstack.faults.base import Fault
from wsn_tracking.zstack.motes import Message

RETRY_S = (0.005, 0.06)  # until a node that has heard no acknowledgement repeats a message
RELAY_S = (0.002, 0.03)  # until a broadcast comes by another way
ANOTHER_RELAY = 0xF0F0
STRANGE_CLUSTER, STRANGE_ENDPOINT = 0x0006, 1
STRANGE_VERSION = 2
STRANGE_DATA = bytes.fromhex('18 07 0A 00 00 20 F3')  # a report of a home automation sensor


class Duplicates(Fault):
    """A node repeats a message: the same bytes, the same way."""

    def air(self, messages: list[Message]) -> list[Message]:
        """Each message, and some twice."""
        again = [m._replace(time_s=m.time_s + self.random.uniform(*RETRY_S)) for m in messages if self.hits()]
        return sorted([*messages, *again], key=lambda m: m.time_s)


class Relayed(Fault):
    """A broadcast reaches the sink by two ways: the second is a hop longer and comes from another radio."""

    def air(self, messages: list[Message]) -> list[Message]:
        """Each message, and some twice."""
        heard = []
        for message in messages:
            if not self.hits():
                heard.append(message)
                continue
            once = message._replace(was_broadcast=True)
            late = message.time_s + self.random.uniform(*RELAY_S)
            heard += [once, once._replace(time_s=late, mac_src=ANOTHER_RELAY, hops=message.hops + 1)]
        return sorted(heard, key=lambda m: m.time_s)


class Reorder(Fault):
    """A message waits in a relay until the next one of its node has overtaken it."""

    def __init__(self, value: float, seconds: float, seed: int) -> None:
        super().__init__(value, seconds, seed)
        self._waiting: dict[int, Message] = {}

    def air(self, messages: list[Message]) -> list[Message]:
        """Some are held back, and come right after their successor."""
        heard = []
        for message in messages:
            waiting = self._waiting.pop(message.src, None)
            if waiting is not None:
                heard += [message, waiting._replace(time_s=message.time_s)]
            elif self.hits():
                self._waiting[message.src] = message
            else:
                heard.append(message)
        return heard

    def held(self) -> list[Message]:
        """Those that nothing has overtaken."""
        held, self._waiting = self._waiting, {}
        return list(held.values())


class Lost(Fault):
    """A message that no radio received."""

    def air(self, messages: list[Message]) -> list[Message]:
        """The others."""
        return [message for message in messages if not self.hits()]


class PayloadCrc(Fault):
    """A payload that was damaged within the node: frame and radio find nothing wrong with it. It is lost."""

    def air(self, messages: list[Message]) -> list[Message]:
        """Some with a bit that is wrong."""
        return [self._damaged(message) if self.hits() else message for message in messages]

    def _damaged(self, message: Message) -> Message:
        data = bytearray(message.bytes)
        data[self.random.randrange(len(data))] ^= 1 << self.random.randrange(8)
        return message._replace(data=bytes(data))


class UnknownVersion(Fault):
    """A node with newer firmware speaks beside the others."""

    def air(self, messages: list[Message]) -> list[Message]:
        """The messages, and some in a version that nobody knows."""
        return [m for message in messages for m in self._both(message)]

    def _both(self, message: Message) -> list[Message]:
        if not self.hits():
            return [message]
        import binascii

        body = bytearray(message.bytes[:-2])
        body[0] = STRANGE_VERSION << 4 | body[0] & 0x0F
        strange = bytes(body) + binascii.crc_hqx(bytes(body), 0xFFFF).to_bytes(2, 'little')
        return [message._replace(data=strange), message]


class ForeignCluster(Fault):
    """A sensor of another kind sends to our endpoint."""

    def air(self, messages: list[Message]) -> list[Message]:
        """The messages, and some of strangers."""
        strange = [m._replace(cluster=STRANGE_CLUSTER, data=STRANGE_DATA) for m in messages if self.hits()]
        return sorted([*messages, *strange], key=lambda m: m.time_s)


class ForeignEndpoint(Fault):
    """A sensor of another kind sends to another application of the host."""

    def air(self, messages: list[Message]) -> list[Message]:
        """The messages, and some of strangers."""
        strange = [m._replace(endpoint=STRANGE_ENDPOINT, data=STRANGE_DATA) for m in messages if self.hits()]
        return sorted([*messages, *strange], key=lambda m: m.time_s)


class TwoAddresses(Fault):
    """Two radios bear the same id: the second says the same, under its own numbers and address."""

    def __init__(self, value: float, seconds: float, seed: int) -> None:
        super().__init__(value, seconds, seed)
        self._seq: dict[int, int] = {}  # of each second radio

    def air(self, messages: list[Message]) -> list[Message]:
        """The messages, and those of the second radios: of the nodes that the share picks."""
        second = []
        for message in messages:
            node_id = message.payload.node_id
            if node_id not in self._seq:
                self._seq[node_id] = 30_000 if self.hits() else -1
            if self._seq[node_id] >= 0:
                self._seq[node_id] += 1
                clock = ((message.payload.t_ms or 0) + 500_000_000) % 2**32
                payload = message.payload._replace(seq=self._seq[node_id] % 65536, t_ms=clock)
                address = message.src ^ 0x8000
                second.append(message._replace(payload=payload, src=address, mac_src=address, hops=1))
        return sorted([*messages, *second], key=lambda m: m.time_s)
