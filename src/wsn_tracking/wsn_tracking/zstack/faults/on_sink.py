"""Faults of the sink: answers that are missing, late or refusals; restarts, and a plug that is pulled."""

from __future__ import annotations

from collections.abc import Sequence

from wsn_tracking.zstack.faults.base import Event, Fault, Happening
from wsn_tracking.zstack.frames import Frame, Kind, encode_frame
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload

EXT_NWK_INFO = 0x2550
STALE_MESSAGE = 0x4481


class RpcErrors(Fault):
    """Requests that are refused."""

    def refuses(self, request: Frame) -> bool:
        """Some of those that want an answer."""
        return request.kind == Kind.SREQ and self.hits()


class NoNetworkInfo(Fault):
    """A firmware without ZDO_EXT_NWK_INFO."""

    def refuses(self, request: Frame) -> bool:
        """That one."""
        return request.header == EXT_NWK_INFO and self.hits()


class MissingReply(Fault):
    """Answers that get lost."""

    def reply(self, request: Frame, replies: Sequence[Frame]) -> list[tuple[float, Frame]]:
        """Nothing."""
        return super().reply(request, () if replies and self.hits() else replies)


class LateReply(Fault):
    """Answers that come when nobody waits for them any more."""

    def reply(self, request: Frame, replies: Sequence[Frame]) -> list[tuple[float, Frame]]:
        """The answers, later."""
        late = self.seconds if replies and self.hits() else 0.0
        return [(late, reply) for reply in replies]


class Once(Fault):
    """Something that happens to the sink as an epoch begins."""

    event: Event

    def happens(self, epoch: int) -> Happening | None:
        """Once."""
        if epoch != int(self.value) or self.strikes:
            return None
        self.strikes += 1
        return Happening(self.event, self.seconds)


class Reset(Once):
    """The sink's watchdog restarts it: what was registered is gone."""

    event = Event.RESET


class Unplug(Once):
    """The sink is unplugged, and plugged in again: its device has another name then."""

    event = Event.UNPLUG


class Mute(Once):
    """The sink says nothing, and hears nothing, for a while."""

    event = Event.MUTE


class Stale(Fault):
    """Input from before the host came: half a frame, and old messages."""

    def at_plug(self) -> bytes:
        """What lies in the buffer of the port."""
        self.strikes += 1
        payload = encode_payload(Payload(PayloadType.HEARTBEAT, 1, 0xFFFF, 1))
        head = bytes.fromhex('0000 1000 3E14 E8 E8 00 67 00 350C0000 00') + bytes((len(payload),))
        frame = encode_frame(Frame(STALE_MESSAGE, head + payload + bytes.fromhex('3E14 1D')))
        return frame[7:] + frame * 3 + frame[:9]
