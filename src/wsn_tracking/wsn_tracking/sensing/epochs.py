"""Epoch assembly: closes epochs in order, each when the lists say that nothing of it is still to come.

Messages of one epoch come from several publishers and overtake each other; no clock says when it is
complete. A feeder's EpochEnd, or the sensing nodes' TriggerReports, list what was sent. Only the requests, which
have one publisher, tell the order of epochs, and where a new run begins.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable

from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.average import one_a_node, unusable
from wsn_tracking.sensing.open_epochs import MAX_OPEN, Listing, OpenEpoch, OpenEpochs
from wsn_tracking.sensing.roster import Roster
from wsn_tracking.sensing.runs import Message, begins, falls_back, is_confirmed, is_stray
from wsn_tracking.sensing.values import Epoch, EpochEnd, Measurement, Request, TriggerReport

MAX_LATE = 1000  # late messages held in case a new run's request is still to come
MAX_AHEAD = 10_000  # messages of a new run held while the old one closes
JOINING = 2.0  # [s] what a reader of a running feed waits for an epoch whose first part it may have missed

NO_LOSS = ('used', 'epochs', 'lists', 'late_list', 'other_node', 'renumbered')  # counters of what was not dropped


class EpochAssembler:
    """Turns messages in any order into epochs in order.

    roster: the nodes whose measurements count and whose lists are waited for. loss_timeout [s] of silence
    closes an epoch without what is missing and counts it (`lost`), or raises where `lossless` promises that
    nothing can be missing. A reader that joins a running feed begins with the first epoch that it has whole.
    `counters` tells what was not used, by reason: every message is used (`used`
    measurements, `lists`, a request an epoch), held, or counted under one reason.

    A new run begins with a request that falls back in time (`runs` grows: whoever tracks starts anew), or in
    number alone (the target was restarted). The old run's epochs are closed first.
    """

    def __init__(
        self,
        roster: Iterable[int],
        known: Iterable[int] | None = None,
        target_id: int = -1,
        loss_timeout: float = 2.0,
        lossless: bool = False,
    ) -> None:
        self._roster = Roster(roster, known)
        self.target_id = target_id
        self.loss_timeout = loss_timeout
        self.lossless = lossless
        self.counters: Counter[str] = Counter()
        self.runs = 0
        self._before: Counter[str] = Counter()  # counters at the start of the run
        self._open = OpenEpochs()
        self._first: int | None = None  # number of the run's first epoch
        self._closed: int | None = None  # number of the epoch that was closed last
        self._newest: Request | None = None
        self._late: deque[tuple[str, Measurement | Listing]] = deque(maxlen=MAX_LATE)
        self._ahead: list[Message] = []  # a new run, from its request on, while the old one closes

    # ---- what comes in

    def request(self, request: Request, now: float) -> None:
        """A target asks to be located: the stream of requests is what orders epochs."""
        if self._is_ours(request):
            self._take_request(request, now)

    def measurement(self, packet: Measurement, now: float) -> None:
        """One node's packet."""
        if not self._is_ours(packet):
            return
        if reason := self._roster.refuses(packet.node_id):
            self.counters[reason] += 1
        else:
            self._take_packet(packet, now)

    def listing(self, listing: Listing, now: float) -> None:
        """What was sent in an epoch: by everyone (EpochEnd), or by the nodes that a report names."""
        if not self._is_ours(listing):
            return
        if covered := self._roster.covered(listing):
            self._roster.heard(covered)
            self._take_list(listing, now)
        else:
            self.counters['other_node'] += 1

    # ---- what goes out

    def closed(self, now: float) -> list[Epoch]:
        """The epochs that can be closed by now, in order; of one run at a time, so call again while there are any."""
        self._follow(now)
        out = []
        while (epoch := self._open.head) is not None:
            if epoch.lacks(self._roster.awaited):
                if self._began_before(epoch, now):
                    self._first = epoch.seq + 1
                    self.counters['before_start'] += self._open.pop(epoch.seq).messages
                    continue
                if now - epoch.touched < self.loss_timeout and len(self._open) <= MAX_OPEN:
                    break
                if self._ahead and falls_back(self._ahead[0], self._newest):
                    self._discard_open()  # the old run was cut off
                    break
                self._count_loss(epoch)
            out.append(self._close(epoch.seq))
        return out

    @property
    def run_counters(self) -> Counter[str]:
        """The counters since the last jump back in time."""
        return self.counters - self._before

    @property
    def waits_for(self) -> str:
        """What the oldest open epoch still lacks, in words; empty when nothing is awaited."""
        head = self._open.head
        if head is not None:
            return f'epoch {head.seq}: {head.missing(self._roster.awaited)}'
        return 'the first request' if self._first is None else ''

    @property
    def held(self) -> int:
        """How many messages wait for others."""
        return self._open.messages + len(self._ahead)

    # ---- within

    def _take_request(self, request: Request, now: float) -> None:
        if self._ahead:
            self._take_second(request, now)
            return
        if begins(request, self._newest):
            self._ahead.append(request)
            self._follow(now)
            return
        if self._first is None:
            self._first = request.seq
            for seq in self._open.seqs:
                if seq < request.seq:
                    self.counters['before_start'] += self._open.pop(seq).messages
        if request.seq < self._first or (self._closed is not None and request.seq <= self._closed):
            self.counters['late_request'] += 1
        elif not self._open.ask(request, now):
            self.counters['duplicate_request'] += 1
        self._count_overflow()
        if self._newest is None or request.seq > self._newest.seq:
            self._newest = request
        self._revive(request, now)

    def _take_second(self, request: Request, now: float) -> None:
        """A request while a new run waits to begin: it belongs there, or shows that there is none."""
        if request == self._newest:
            self.counters['duplicate_request'] += 1
            return
        if not is_stray(self._ahead[0], request, self._newest):
            self._hold(request)
            self._follow(now)
            return
        self.counters['stray_request'] += 1
        held, self._ahead = self._ahead[1:], []
        for message in (*held, request):
            self._add(message, now)

    def _take_packet(self, packet: Measurement, now: float) -> None:
        if self._is_of_next_run(packet):
            self._hold(packet)
        elif not self._put_aside(packet, 'late'):
            self._count(self._open.add(packet, now))

    def _take_list(self, listing: Listing, now: float) -> None:
        if self._is_of_next_run(listing):
            self._hold(listing)
        elif not self._put_aside(listing, 'late_list'):
            self._count(self._open.cover(listing, self._roster.covered(listing), self._roster.sent(listing), now))

    def _is_ours(self, message: Message) -> bool:
        if self.target_id < 0:
            self.target_id = message.target_id
        if message.target_id != self.target_id:
            self.counters['other_target'] += 1
            return False
        return True

    def _put_aside(self, message: Measurement | Listing, late: str) -> bool:
        """Whether a message comes too late; it is kept for a while, since a new run's request may be on its way."""
        if self._first is not None and message.request_seq < self._first:
            late = 'before_start'
        elif self._closed is None or message.request_seq > self._closed:
            return False
        self.counters[late] += 1
        self._late.append((late, message))
        return True

    def _revive(self, request: Request, now: float) -> None:
        """What overtook the request of a new run looked late: it counts after all."""
        held, self._late = self._late, deque(maxlen=MAX_LATE)
        for reason, message in held:
            if (message.request_seq, message.stamp_ns) == (request.seq, request.stamp_ns):
                self.counters[reason] -= 1
                self._add(message, now)
            else:
                self._late.append((reason, message))

    def _add(self, message: Message, now: float) -> None:
        if isinstance(message, Request):
            self._take_request(message, now)
        elif isinstance(message, (EpochEnd, TriggerReport)):
            self._take_list(message, now)
        else:
            self._take_packet(message, now)

    def _count(self, reason: str) -> None:
        if reason:
            self.counters[reason] += 1
        self._count_overflow()

    def _count_overflow(self) -> None:
        if self._open.gave_way:
            self.counters['overflow'] += self._open.gave_way
            self._open.gave_way = 0

    # ---- closing

    def _began_before(self, epoch: OpenEpoch, now: float) -> bool:
        """Whether part of it was sent before this reader was there, though nothing is lost: a later one is whole."""
        then = now - JOINING
        begins = self.lossless and not self.counters['epochs'] and epoch.touched <= then
        return begins and self._open.has_whole(self._roster.nodes, then)

    def _count_loss(self, epoch: OpenEpoch) -> None:
        if self.lossless:
            raise TrackingError(
                f'epoch {epoch.seq} lacks {epoch.missing(self._roster.awaited)}: nothing may be missing in a replay, '
                f'so its feed is broken or too slow for `loss_timeout`, {self.loss_timeout:g} s'
            )
        unlisted = self._roster.nodes - epoch.covered
        self._roster.missed(unlisted)
        losses = {'lost': len(epoch.lost), 'lost_request': epoch.request is None, 'unlisted_epoch': bool(unlisted)}
        self.counters.update({reason: int(count) for reason, count in losses.items() if count})

    def _close(self, seq: int) -> Epoch:
        epoch = self._open.pop(seq)
        self._closed = seq
        sent = epoch.sent()
        measurements = one_a_node(sent)
        invalid = unusable(sent)  # whoever reads the epoch leaves them out
        counts = {
            'used': len(sent) - invalid,
            'invalid': invalid,
            'late': len(epoch.packets) - len(sent),
            'lists': len(epoch.lists),
            'epochs': 1,
        }
        self.counters.update({name: count for name, count in counts.items() if count})
        return Epoch(self.target_id, seq, epoch.stamp_ns, measurements)

    # ---- runs

    def _is_of_next_run(self, message: Measurement | Listing) -> bool:
        """While an old run closes: whether a message is not one that it lacks."""
        if not self._ahead:
            return False
        epoch = self._open.get(message.request_seq)
        if epoch is None or epoch.request is None:
            return True
        if abs(message.stamp_ns - epoch.stamp_ns) > abs(message.stamp_ns - self._ahead[0].stamp_ns):
            return True
        if isinstance(message, (EpochEnd, TriggerReport)):
            return epoch.covered.issuperset(self._roster.covered(message))
        return (message.node_id, message.seq) in epoch.packets

    def _hold(self, message: Message) -> None:
        if len(self._ahead) >= MAX_AHEAD:
            self.counters['overflow'] += 1
        else:
            self._ahead.append(message)

    def _follow(self, now: float) -> None:
        """Begin the next run when the last one is closed."""
        if not self._ahead or self._open.head is not None or not is_confirmed(self._ahead, self._newest):
            return
        first, *others = self._ahead
        if falls_back(first, self._newest):
            self.runs += 1
            self._roster.begin_anew()
            self._before = self.counters.copy()
        else:
            self.counters['renumbered'] += 1
        self._discard_open()
        self._ahead, self._first, self._closed, self._newest = [], None, None, None
        for message in (first, *others):
            self._add(message, now)

    def _discard_open(self) -> None:
        """Drop what is open; a message of the run to come that overtook its request is kept for that."""
        for seq in self._open.seqs:
            epoch = self._open.pop(seq)
            self.counters['discarded_by_reset'] += epoch.messages
            self._late.extend(('discarded_by_reset', m) for m in (*epoch.packets.values(), *epoch.lists))
