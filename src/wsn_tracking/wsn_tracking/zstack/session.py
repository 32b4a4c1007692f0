"""The link to a sink, kept up for ever: one thread opens, probes, attaches, reads, watches, and opens again."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.commands import AfDataConfirm, Command
from wsn_tracking.zstack.commands.table import BY_CLASS
from wsn_tracking.zstack.conversation import Questions, Watchdog, speak
from wsn_tracking.zstack.counters import new_counters
from wsn_tracking.zstack.dialogue import Dialogue
from wsn_tracking.zstack.forming import check_confirmed, form, is_formed
from wsn_tracking.zstack.frames import Kind
from wsn_tracking.zstack.line import Bell, Line
from wsn_tracking.zstack.link import LinkEvent, Status
from wsn_tracking.zstack.port import Port, open_port
from wsn_tracking.zstack.protocols import Item, protocol_of
from wsn_tracking.zstack.queues import Inbox, Outbox, Outgoing, Received
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.settings import LinkConfig
from wsn_tracking.zstack.startup import Sink, attach, probe


class Session:
    """Between `start` and `close`, `inbox` fills; `wake` is called then, in the thread of the link."""

    def __init__(self, config: LinkConfig, wake: Callable[[], None] = lambda: None) -> None:
        self.config = config
        self.status = Status(port=config.port)
        self._counters = new_counters()
        self.inbox = Inbox(config.host_queue, self._counters)
        self._outbox = Outbox(config.radio, config.send_queue, config.timeout, self._counters)
        self._questions = Questions(maxlen=config.send_queue)
        self._protocol = protocol_of(config.sink_protocol, config.radio, config.timeout.gap)
        self._wake = wake
        self._was_up = False  # since the port was opened
        self._formings = 0
        self._has_formed = False
        self._dialogue: Dialogue | None = None  # on the port that is open
        self._bell = Bell()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name='sink', daemon=True)

    def start(self) -> None:
        """Open the port, now and whenever it is lost."""
        self._thread.start()

    def close(self) -> None:
        """Give the port back."""
        if not self._stop.is_set():
            self._stop.set()
            self._bell.ring()
            self._thread.join()
            self._bell.close()

    @property
    def counters(self) -> dict[str, int]:
        """Everything that was counted since the start."""
        return {**self._counters, **self._protocol.counters}

    @property
    def looked_ns(self) -> int | None:
        """What the line had delivered by then is in the inbox, host clock (monotonic) [ns]; None: no line is open."""
        dialogue = self._dialogue
        return None if dialogue is None else dialogue.looked_ns

    def look(self) -> None:
        """Have the line looked at now, also if nothing comes."""
        self._bell.ring()

    def send(self, dst: int, data: bytes) -> None:
        """Have a payload sent to a node, or to all (0xFFFF), if the link is up within timeout.send_age."""
        self._outbox.put(Outgoing(dst, data, time.monotonic()))
        self._bell.ring()

    def ask(self, question: Command, answer: type[Command]) -> None:
        """Put a question to the sink, when the link is up; the indications that follow come into the inbox."""
        self._questions.append((question, answer))
        self._bell.ring()

    def _run(self) -> None:
        timeout = self.config.timeout
        delay = timeout.reopen_first
        while not self._stop.is_set():
            self._was_up = False
            try:
                self._open()
            except TrackingError as error:
                reason = str(error)
            except Exception as error:  # noqa: BLE001 - a fault of ours must not leave the link down for ever
                self._counters['internal_errors'] += 1
                reason = f'internal error: {error!r}'
            if self._stop.is_set():
                break
            self._counters['lost' if self._was_up else 'open_failed'] += 1
            self.status = self.status._replace(phase='lost', error=reason)
            self._deliver(LinkEvent('lost', reason), time.monotonic_ns())
            delay = timeout.reopen_first if self._was_up else delay
            self._stop.wait(delay)
            delay = min(2 * delay, timeout.reopen_last)
        self.status = self.status._replace(phase='closed')

    def _open(self) -> None:
        config = self.config
        port = open_port(config.port, config.baud, config.timeout.reply, rtscts=config.rtscts)
        try:
            self._counters['opened'] += 1
            self.status = self.status._replace(phase='opening', device=port.device)
            self._serve(port)
        finally:
            self._dialogue = None
            for item in self._protocol.flush():  # the line broke off in the middle of something
                self._hear(item, time.monotonic_ns())
            self._outbox.forget()
            with contextlib.suppress(TrackingError):
                port.close()

    def _serve(self, port: Port) -> None:
        """Everything that happens on an open port; ends with an error."""
        config = self.config
        line = Line(port, self._protocol, config.timeout.gap, self._bell)
        self._stop.wait(config.timeout.settle)
        self._counters['stale_bytes'] += line.drop()
        self._deliver(LinkEvent('opened', port.device), time.monotonic_ns())
        dialogue = Dialogue(line, config.timeout, self._counters, self._hear, self._stop.is_set)
        self._dialogue = dialogue
        if config.sink_protocol != 'znp':
            self._come_up()
            while True:
                dialogue.listen(time.monotonic() + config.timeout.idle)
        self._probe(dialogue)
        self._attach(dialogue)
        watchdog = Watchdog(dialogue, config.radio)
        while True:
            if dialogue.restarted:
                self._outbox.forget()
                self._deliver(LinkEvent('restarted'), time.monotonic_ns())
                self._attach(dialogue)
            # Whatever is said lets things come in: they are looked at before the line is waited for.
            elif not speak(dialogue, self._outbox, self._questions) and not watchdog.look():
                dialogue.listen(min(watchdog.due, self._outbox.deadline))

    def _probe(self, dialogue: Dialogue) -> None:
        config = self.config
        self.status = self.status._replace(phase='probing')
        sink = probe(dialogue, toggle_dtr_rts=config.toggle_dtr_rts)
        self.status = self.status._replace(sink=sink)
        if config.form.confirm and not self._has_formed and not is_formed(dialogue, sink, config.form):
            self._form(dialogue, sink)

    def _form(self, dialogue: Dialogue, sink: Sink) -> None:
        """Once: what is erased again and again wears the sink's memory out, and its nodes lose their network."""
        form_config, tries = self.config.form, self.config.timeout.tries
        check_confirmed(sink, form_config.confirm)
        if self._formings >= tries:
            raise TrackingError(
                f'no network came of forming one {tries} times: nothing more is erased until a new start'
            )
        self._formings += 1
        form(dialogue, sink, form_config)
        self._has_formed = True

    def _attach(self, dialogue: Dialogue) -> None:
        """Attach, and again if the sink restarts meanwhile."""
        self.status = self.status._replace(phase='attaching')
        while True:
            dialogue.restarted = False
            try:
                network = attach(dialogue, self.config.radio, self.config.multicast_group)
            except TrackingError:
                if not dialogue.restarted or self._stop.is_set():
                    raise
            else:
                break
        self.status = self.status._replace(network=network)
        self._counters['attached'] += 1
        self._come_up()

    def _come_up(self) -> None:
        self._was_up = True
        self.status = self.status._replace(phase='up', error='')
        self._deliver(LinkEvent('up'), time.monotonic_ns())

    def _hear(self, item: Item, arrival_ns: int) -> None:
        if isinstance(item, Bad):
            self._counters[item.reason] += 1
        elif isinstance(item, Report):
            self._counters['reports'] += 1
            self._deliver(item, arrival_ns)
        elif isinstance(item, AfDataConfirm):
            self._outbox.confirm(item)
        elif BY_CLASS[type(item)].header >> 8 & 0xE0 == Kind.AREQ:
            self._deliver(item, arrival_ns)

    def _deliver(self, item: object, arrival_ns: int) -> None:
        self.inbox.put(Received(item, arrival_ns))
        try:
            self._wake()
        except Exception:  # noqa: BLE001 - a fault of the host must not end the link
            self._counters['internal_errors'] += 1
