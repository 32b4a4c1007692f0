import contextlib
import dataclasses
import os
import random
import time

import pytest
from fake_sink import IEEE, PATIENCE, FakeSink, script
from zstack_cases import BYTES, line_bytes, message, report_payload

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack import session as session_module
from wsn_tracking.zstack.frames import Frame, encode_frame
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.link import LinkEvent
from wsn_tracking.zstack.payload import Payload, PayloadType, encode_payload
from wsn_tracking.zstack.port import open_port
from wsn_tracking.zstack.records import FeedbackRecord, RssiRecord
from wsn_tracking.zstack.reports import Report
from wsn_tracking.zstack.session import Session
from wsn_tracking.zstack.settings import FormConfig, LinkConfig, TimeoutConfig

FAST = TimeoutConfig(
    settle=0.01,
    gap=0.05,
    ping=0.3,
    wake=0.05,
    reply=0.5,
    startup=0.5,
    reset=1.0,
    commissioning=0.5,
    idle=5.0,
    confirm=0.5,
    reopen_first=0.02,
    reopen_last=0.05,
)
IMPATIENT = dataclasses.replace(FAST, idle=0.05, ping=0.05)
FEEDBACK = encode_payload(Payload(PayloadType.FEEDBACK, 0, 1, 0, (FeedbackRecord(1, 0.5, 0.5, 0.0, 0.0),)))
WRITES = (c.NvWrite, c.SysResetReq, c.BdbSetChannel, c.BdbStartCommissioning)


class Host:
    """A session, and what came out of it."""

    def __init__(self, link, **config):
        self.session = Session(LinkConfig(port=str(link), **{'timeout': FAST, **config}))
        self.received = []
        self.session.start()

    def until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, (self.session.status, self.session.counters, self.received)
            self.received += self.session.inbox.take(0.05)

    def wait_up(self, times=1):
        self.until(lambda: self.events('up') >= times)

    def wait_seqs(self, seqs):
        self.until(lambda: len(self.seqs) >= len(seqs))
        assert self.seqs == list(seqs)

    def wait_counted(self, name, n=1):
        self.until(lambda: self.session.counters[name] >= n)

    def events(self, kind):
        return sum(isinstance(r.item, LinkEvent) and r.item.kind == kind for r in self.received)

    @property
    def seqs(self):
        return [r.item.payload.seq for r in self.received if isinstance(r.item, Report)]

    def counted(self, name):
        return self.session.counters[name]


@pytest.fixture
def link(tmp_path):
    return tmp_path / 'sink'


@pytest.fixture
def sink(link):
    with contextlib.closing(FakeSink(link)) as fake:
        yield fake


@pytest.fixture
def host(link):
    with contextlib.ExitStack() as stack:

        def make(**config):
            made = Host(link, **config)
            stack.callback(made.session.close)
            return made

        yield make


def data(seq, **more):
    return line_bytes(message(report_payload(seq=seq), ticks=1000 * seq, **more))


def test_attaches_to_a_formed_network_without_writing_to_its_memory(sink, host):
    up = host()
    up.wait_up()
    kinds = [type(asked) for asked in sink.asked]
    assert kinds == [
        c.SysPing,
        c.SysVersion,
        c.UtilGetDeviceInfo,
        c.UtilGetDeviceInfo,
        c.AfRegister,
        c.ZdoExtNwkInfo,
    ]
    assert sink.questions(c.AfRegister) == [c.AfRegister(0xE8, 0xBF01, 0, 0, 0, (0x0010,), ())]
    status = up.session.status
    assert (status.phase, status.error, status.device) == ('up', '', sink.device)
    assert (status.sink.version.product, status.sink.device.ieee, status.network.channel) == (0, IEEE, 11)


def test_reports_are_delivered_in_order_with_their_arrival(sink, host):
    up = host()
    up.wait_up()
    before = time.monotonic_ns()
    for seq in range(100):
        sink.say(data(seq))
    up.wait_seqs(range(100))
    arrivals = [r.arrival_ns for r in up.received if isinstance(r.item, Report)]
    assert before < arrivals[0] <= arrivals[-1] < time.monotonic_ns()
    assert arrivals == sorted(arrivals)


def test_garbage_partial_frames_and_single_bytes_lose_nothing(sink, host):
    up = host()
    up.wait_up()
    sink.say(b'Boot 1.2\r\n', data(0), b'\xfe\x2a\x44', data(1), data(2)[:20])
    up.wait_seqs(range(2))
    up.wait_counted('gaps')  # the rest of it never comes
    for byte in data(3):
        sink.say(bytes((byte,)))
    broken = bytearray(data(4))
    broken[30] ^= 0x10
    long = bytearray(data(4))
    long[1] = 0xF0
    sink.say(data(4), bytes(broken), bytes(long), b'\xfe\xff', data(5), data(6), data(7))
    up.until(lambda: len(up.seqs) == 7)
    assert up.seqs == [0, 1, 3, 4, 5, 6, 7]
    assert up.counted('bad_fcs') >= 1


def test_reports_come_while_the_sink_is_being_asked(sink, host):
    sink.answers[c.AfRegister] = [data(1), c.AfRegisterRsp(0), data(2)]
    sink.answers[c.SysPing] = [data(0), c.SysPingRsp(1)]
    up = host()
    up.wait_seqs([0, 1, 2])


@pytest.mark.parametrize('status', [0, 1])
def test_network_that_is_down_is_started(sink, host, status):
    """Status 1 is a new network, and no error; the state may change before the answer is given."""
    sink.answers = script(state=0)
    sink.answers[c.ZdoStartup] = [c.ZdoStateChangeInd(8), c.ZdoStateChangeInd(9), c.ZdoStartupRsp(status)]
    up = host()
    up.wait_up()
    assert sink.questions(c.ZdoStartup) == [c.ZdoStartup(100)]
    assert not sink.questions(WRITES)


def test_state_is_asked_for_when_its_indication_was_lost(sink, host):
    sink.answers = script(state=0)

    def started(asked):
        sink.answers[c.UtilGetDeviceInfo] = [c.UtilGetDeviceInfoRsp(0, IEEE, 0, 7, 9)]
        return [c.ZdoStartupRsp(0)]

    sink.answers[c.ZdoStartup] = started
    host().wait_up()


@pytest.mark.parametrize(
    ('kind', 'answer', 'words'),
    [
        (c.ZdoStartup, [c.ZdoStartupRsp(2)], 'cannot start its network'),
        (c.ZdoStartup, [c.ZdoStartupRsp(0)], 'does not come up'),
        (c.AfRegister, [c.AfRegisterRsp(0x11)], 'refuses to register'),
        (c.AfRegister, [c.RpcError(2, 0x24, 0x00)], 'unknown command'),
        (c.AfRegister, [], 'does not answer AF_REGISTER'),
        (c.ZdoExtAddGroup, [c.ZdoExtAddGroupRsp(1)], 'refuses multicast group'),
    ],
)
def test_refusal_is_said_and_tried_again(sink, host, kind, answer, words):
    sink.answers = script(state=0)
    sink.answers[kind] = answer
    up = host(multicast_group=0x0101)
    up.until(lambda: words in up.session.status.error)
    sink.answers = script()
    up.wait_up()


@pytest.mark.parametrize('status', [0x02, 0xB8])
def test_endpoint_that_is_registered_already_is_registered(sink, host, status):
    sink.answers[c.AfRegister] = [c.AfRegisterRsp(status)]
    host().wait_up()


@pytest.mark.parametrize('answer', [[], [c.RpcError(2, 0x25, 0x50)]])
def test_sink_that_does_not_tell_its_network_is_used(sink, host, answer):
    sink.answers[c.ZdoExtNwkInfo] = answer
    up = host()
    up.wait_up()
    assert up.session.status.network is None


def test_rpc_error_fails_at_once(sink, host):
    sink.answers[c.ZdoExtNwkInfo] = [c.RpcError(2, 0x25, 0x50)]
    slow = dataclasses.replace(FAST, reply=PATIENCE)
    up = host(timeout=slow)
    began = time.monotonic()
    up.wait_up()
    assert time.monotonic() - began < PATIENCE / 2
    assert up.counted('rpc_errors') == 1


def test_missing_answer_is_asked_for_again(sink, host):
    def second_time(asked):
        return [c.AfRegisterRsp(0)] if len(sink.questions(c.AfRegister)) == 3 else []

    sink.answers[c.AfRegister] = second_time
    up = host()
    up.wait_up()
    assert (up.counted('no_answers'), up.counted('repeated_requests')) == (2, 2)


def test_late_and_foreign_answers_are_discarded(sink, host):
    """An answer to a question given up, and RPC errors about others, are not taken for the answer."""
    sink.answers[c.SysVersion] = [c.NvWriteRsp(9), c.RpcError(2, 0x24, 0x00), c.SysVersionRsp(2, 0, 2, 6, 3)]
    sink.answers[c.AfRegister] = [c.SysVersionRsp(2, 1, 9, 9, 9), c.AfRegisterRsp(0)]
    up = host()
    up.wait_up()
    assert up.counted('late_answers') == 3
    assert up.session.status.sink.version.product == 0


def test_sleeping_sink_is_woken(sink, host):
    def awake(asked):
        return [c.SysPingRsp(1)] if sink.other.count(b'\xef') == 256 else []

    sink.answers[c.SysPing] = awake
    host().wait_up()
    assert sink.other == b'\xef' * 256


def test_reset_lines_of_a_port_that_has_none_are_an_error_that_says_so(sink, host):
    sink.mute = True
    up = host(toggle_dtr_rts=True)
    up.until(lambda: 'set toggle_dtr_rts to false' in up.session.status.error)


def test_reset_in_mid_run_registers_again_and_loses_nothing(sink, host):
    up = host()
    up.wait_up()
    sink.say(data(0), data(1))
    sink.say(c.SysResetInd(2, 2, 0, 2, 6, 3))
    sink.wait_asked(c.AfRegister, 2)
    sink.say(data(2), data(3))
    up.wait_seqs(range(4))
    up.wait_up(2)
    items = [r.item for r in up.received]
    (reset,) = [i for i, item in enumerate(items) if isinstance(item, c.SysResetInd)]
    assert [item.payload.seq for item in items[:reset] if isinstance(item, Report)] == [0, 1]
    assert (up.counted('resets'), up.counted('attached'), up.counted('lost')) == (1, 2, 0)


def test_reset_while_attaching_begins_again(sink, host):
    def first_time(asked):
        first = len(sink.questions(c.AfRegister)) == 1
        return [c.SysResetInd(0, 2, 0, 2, 6, 3)] if first else [c.AfRegisterRsp(0)]

    sink.answers[c.AfRegister] = first_time
    up = host()
    up.wait_up()
    assert (len(sink.questions(c.AfRegister)), up.counted('open_failed'), up.counted('opened')) == (2, 0, 1)


def test_line_is_looked_at_when_the_host_asks_for_it(sink, host):
    """Whoever waits for the end of an epoch can be sure that nothing lies unread."""
    up = host()
    up.wait_up()
    sink.say(data(3))
    asked = time.monotonic_ns()
    up.session.look()
    up.until(lambda: (up.session.looked_ns or 0) > asked)
    up.wait_seqs([3])
    sink.unplug()
    up.until(lambda: up.session.looked_ns is None)


def test_silent_sink_is_pinged_and_kept(sink, host):
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.wait_asked(c.SysPing, 5)
    assert up.counted('lost') == 0


def test_restart_of_which_the_line_told_nothing_is_found_out(sink, host):
    """The sink's word was lost: it answers pings, its network is down, and it has forgotten our endpoint."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.answers[c.UtilGetDeviceInfo] = [c.UtilGetDeviceInfoRsp(0, IEEE, 0xFFFE, 7, 0)]
    sink.answers[c.AfRegister] = lambda asked: [sink.answers.update(script()) or c.AfRegisterRsp(0)]
    sink.wait_asked(c.ZdoStartup)
    up.wait_up(2)
    assert (up.counted('resets'), up.counted('found_down'), up.counted('lost')) == (0, 1, 0)


def test_mute_sink_is_lost_after_three_pings_and_opened_for_ever(sink, host):
    up = host(timeout=IMPATIENT)
    up.wait_up()
    sink.mute = True
    up.until(lambda: up.events('lost') >= 4)
    assert up.counted('lost') == 1
    assert up.counted('pings_missed') >= 3
    sink.mute = False
    up.wait_up(2)
    sink.say(data(7))
    up.wait_seqs([7])


def test_missed_pings_are_forgotten_when_the_sink_speaks(sink, host):
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.answers[c.SysPing] = lambda asked: [c.SysPingRsp(1)] if len(sink.questions(c.SysPing)) % 3 == 0 else []
    sink.wait_asked(c.SysPing, 10)
    assert up.counted('lost') == 0


def test_unplug_and_replug_under_another_name(sink, host):
    up = host()
    up.wait_up()
    sink.say(data(0))
    up.wait_seqs([0])
    keep = os.open(sink.device, os.O_RDWR | os.O_NOCTTY)  # so that the next one cannot get the same name
    try:
        first = sink.device
        sink.unplug()
        up.until(lambda: up.session.counters['open_failed'] >= 2)
        sink.plug()
    finally:
        os.close(keep)
    assert sink.device != first
    up.wait_up(2)
    sink.say(data(1))
    up.wait_seqs([0, 1])
    assert up.session.status.device == sink.device
    assert up.counted('lost') == 1


def comes_through(up, sink, seq):
    """A condition: the report is said until it is heard; noise before it may have begun a frame that takes some in."""

    def heard():
        sink.say(data(seq))
        up.received += up.session.inbox.take(0.05)
        return seq in up.seqs

    return heard


@pytest.mark.parametrize('words', [b'', b'\xfe', data(9)[:20]], ids=['silent', 'after a start byte', 'within a frame'])
def test_port_may_vanish_at_any_moment(sink, host, words):
    """Before the first question, and after each one until the link is up; then it comes back and all is well."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    for step in range(12):
        seen = len(sink.asked)
        sink.wait(lambda n=seen + step: len(sink.asked) >= n)
        if words:
            sink.say(words)
        sink.unplug()
        failed = up.counted('lost') + up.counted('open_failed')
        up.until(lambda n=failed: up.counted('lost') + up.counted('open_failed') > n)
        sink.plug()
    already = up.events('up')
    up.wait_up(already + 1)
    up.until(comes_through(up, sink, 3))
    assert up.counted('internal_errors') == 0


def test_stale_input_is_dropped_at_opening(sink, host):
    waiting = open_port(str(sink.link), 115200, 1.0)  # someone held the port open, and read nothing
    sink.say(data(90), data(91)[:10])
    waiting.close()
    keep = os.open(sink.device, os.O_RDWR | os.O_NOCTTY)
    sink.say(data(92))
    up = host(timeout=dataclasses.replace(FAST, settle=0.2))
    up.wait_up()
    os.close(keep)
    sink.say(data(1))
    up.wait_seqs([1])


def test_port_that_is_open_elsewhere_is_refused_until_it_is_free(sink, host):
    other = open_port(str(sink.link), 115200, 1.0)
    with pytest.raises(TrackingError, match='in use by another program'):
        open_port(str(sink.link), 115200, 1.0)
    up = host()
    up.until(lambda: 'in use' in up.session.status.error)
    other.close()
    up.wait_up()


def test_port_that_does_not_exist_is_waited_for(link, host):
    up = host()
    up.until(lambda: 'no such port' in up.session.status.error)
    with contextlib.closing(FakeSink(link)):
        up.wait_up()
        up.session.close()


def test_slow_host_loses_the_oldest_and_is_told(sink, host):
    up = host(host_queue=10)
    up.until(lambda: up.session.status.up)
    sink.say(*(data(seq) for seq in range(30)))
    end = time.monotonic() + PATIENCE
    while up.session.counters['reports'] < 30:
        assert time.monotonic() < end
    received = up.session.inbox.take()
    assert [r.item.payload.seq for r in received] == list(range(20, 30))
    assert up.counted('host_queue_dropped') >= 20


def test_foreign_and_broken_messages_are_counted(sink, host):
    up = host()
    up.wait_up()
    payload = encode_payload(report_payload())
    sink.say(
        BYTES['AF_IN_1'],
        message(report_payload(), cluster=0x0006),
        message(payload[:-1] + b'\x00'),
        message(b'\x21' + bytes(11) + b'\x00\x00'),
        bytes.fromhex('FE 00 45 55 10'),
        data(1),
    )
    up.wait_seqs([1])
    names = ('foreign_endpoint', 'foreign_cluster', 'payload_crc', 'unknown_command')
    assert [up.counted(name) for name in names] == [1, 1, 2, 1]


def sound_but_hostile(draw, count):
    """Frames that are sound, of any command or none, with data that mean nothing."""
    for _ in range(count):
        header = draw.choice([*c.BY_HEADER, draw.randrange(1 << 16)])
        yield encode_frame(Frame(header, draw.randbytes(draw.choice([0, 1, 3, 5, 14, 24, 60, 250]))))


@pytest.mark.parametrize('seed', range(3))
def test_nothing_that_a_sink_says_breaks_the_host(sink, host, seed):
    """Noise, sound frames of any command with any data, unasked answers, restarts: afterwards reports come."""
    draw = random.Random(seed)
    up = host(host_queue=50)
    up.wait_up()
    for _ in range(20):
        sink.say(*sound_but_hostile(draw, 20))
        sink.say(draw.randbytes(200))
        up.received.clear()
    up.until(comes_through(up, sink, 7))
    assert up.counted('internal_errors') == 0


def test_indications_reach_the_host(sink, host):
    up = host()
    up.wait_up()
    sink.say(BYTES['ENDDEV_ANNCE'], BYTES['SRC_RTG_IND_2'])
    up.session.ask(c.ZdoMgmtLqiReq(0, 0), c.ZdoMgmtLqiReqRsp)
    sink.wait_asked(c.ZdoMgmtLqiReq)
    sink.say(BYTES['MGMT_LQI_RSP'])
    kinds = (c.ZdoEndDeviceAnnceInd, c.ZdoSrcRtgInd, c.ZdoMgmtLqiRsp)
    up.until(lambda: {type(r.item) for r in up.received} >= set(kinds))


# --- down


def test_message_to_a_node_is_sent_and_confirmed(sink, host):
    up = host()
    up.wait_up()
    up.session.send(0x143E, FEEDBACK)
    sent = sink.wait_asked(c.AfDataRequest)
    assert sent == c.AfDataRequest(0x143E, 0xE8, 0xE8, 0x0010, sent.trans_id, 0, 30, FEEDBACK)
    up.wait_counted('confirmed')
    assert (up.counted('sent'), up.counted('send_repeated')) == (1, 0)


@pytest.mark.parametrize(
    'answers',
    [
        lambda asked: [c.AfDataRequestRsp(0), c.AfDataConfirm(0xE9, 0xE8, asked.trans_id)],
        lambda asked: [c.AfDataConfirm(0xE9, 0xE8, asked.trans_id), c.AfDataRequestRsp(0)],
        lambda asked: [c.AfDataRequestRsp(0x02)],
        lambda asked: [c.AfDataRequestRsp(0)],
        lambda asked: [],
        lambda asked: [c.RpcError(3, 0x24, 0x01)],
    ],
    ids=['failed', 'failed early', 'refused', 'unconfirmed', 'unanswered', 'error'],
)
def test_message_that_fails_is_tried_twice(sink, host, answers):
    sink.answers[c.AfDataRequest] = answers
    up = host()
    up.wait_up()
    up.session.send(0x143E, FEEDBACK)
    up.wait_counted('send_failed')
    assert [len(sink.questions(c.AfDataRequest)), up.counted('send_repeated'), up.counted('sent')] == [2, 1, 2]
    sink.answers = script()
    up.session.send(0x143E, FEEDBACK)
    up.wait_counted('confirmed')


def test_at_most_two_messages_are_unconfirmed(sink, host):
    sink.answers[c.AfDataRequest] = [c.AfDataRequestRsp(0)]
    up = host(timeout=dataclasses.replace(FAST, confirm=PATIENCE))
    up.wait_up()
    for _ in range(5):
        up.session.send(0x143E, FEEDBACK)
    for n in range(2, 6):
        sink.wait_asked(c.AfDataRequest, n)
        up.session.ask(c.ZdoMgmtLqiReq(0, 0), c.ZdoMgmtLqiReqRsp)  # comes after whatever is due
        sink.wait_asked(c.ZdoMgmtLqiReq, n - 1)
        assert len(sink.questions(c.AfDataRequest)) == n
        sink.say(c.AfDataConfirm(0, 0xE8, sink.questions(c.AfDataRequest)[n - 2].trans_id))


def test_messages_that_find_no_room_are_counted(sink, host):
    sink.mute = True
    up = host(send_queue=3, timeout=dataclasses.replace(FAST, send_age=PATIENCE))
    for k in range(10):
        up.session.send(k, FEEDBACK)
    assert up.counted('send_queue_dropped') == 7
    sink.mute = False
    sink.wait_asked(c.AfDataRequest, 3)
    assert [asked.dst for asked in sink.questions(c.AfDataRequest)] == [7, 8, 9]


def test_reset_repeats_what_was_on_its_way(sink, host):
    sink.answers[c.AfDataRequest] = [c.AfDataRequestRsp(0)]
    up = host(timeout=dataclasses.replace(FAST, confirm=PATIENCE))
    up.wait_up()
    up.session.send(1, FEEDBACK)
    sink.wait_asked(c.AfDataRequest)
    sink.answers = script()
    sink.say(c.SysResetInd(2, 2, 0, 2, 6, 3))
    up.wait_counted('confirmed')
    assert up.counted('send_repeated') == 1


# --- forming


def forming(confirm=f'{IEEE:#018x}', **more):
    return {'form': FormConfig(confirm, 15, 0x1A63), **more}


@pytest.mark.parametrize('product', [0, 1, 2])
def test_forming_writes_and_starts_as_the_firmware_wants(sink, host, product):
    sink.answers = script(product=product)
    up = host(**forming())
    up.wait_up()
    mask = (1 << 15).to_bytes(4, 'little')
    assert sink.questions(c.NvWrite) == [
        c.NvWrite(0x0003, 0, b'\x03'),
        c.NvWrite(0x0003, 0, b'\x00'),
        c.NvWrite(0x0087, 0, b'\x00'),
        c.NvWrite(0x008F, 0, b'\x01'),
        c.NvWrite(0x0084, 0, mask),
        c.NvWrite(0x0083, 0, b'\x63\x1a'),
    ]
    assert sink.questions(c.SysResetReq) == [c.SysResetReq(1)]
    if product:
        assert sink.questions(c.BdbSetChannel) == [c.BdbSetChannel(1, 1 << 15), c.BdbSetChannel(0, 0)]
        assert sink.questions(c.BdbStartCommissioning) == [c.BdbStartCommissioning(4)]
    else:
        assert sink.questions(c.ZdoStartup) == [c.ZdoStartup(100)]
    assert len(sink.questions(c.AfRegister)) == 1


@pytest.mark.parametrize('confirm', ['yes', '0x1', f'{IEEE + 1:x}'])
def test_forming_without_the_right_confirmation_writes_nothing(sink, host, confirm):
    up = host(**forming(confirm))
    up.until(lambda: 'to erase it, set form.confirm' in up.session.status.error)
    assert not sink.questions(WRITES)


def test_network_that_is_as_asked_for_is_not_formed_again(sink, host):
    sink.answers[c.ZdoExtNwkInfo] = [c.ZdoExtNwkInfoRsp(0, 9, 0x1A63, 0, 1, 0, 15)]
    up = host(**forming())
    up.wait_up()
    assert not sink.questions(WRITES)


@pytest.mark.parametrize(
    ('kind', 'answer', 'words'),
    [
        (c.NvWrite, [c.NvWriteRsp(0x0A)], 'refuses STARTUP_OPTION'),
        (c.SysResetReq, [], 'does not come back'),
        (c.UtilGetDeviceInfo, [], 'does not tell its IEEE address'),
    ],
)
def test_forming_that_fails_says_where(sink, host, kind, answer, words):
    sink.answers[kind] = answer
    up = host(**forming(timeout=dataclasses.replace(FAST, reset=0.1, reply=0.1)))
    up.until(lambda: words in up.session.status.error)


# --- the other kinds of sink


@pytest.mark.parametrize('protocol', ['mt_app', 'ascii'])
def test_other_kinds_of_sink_are_only_listened_to(sink, host, protocol):
    up = host(sink_protocol=protocol, timeout=IMPATIENT)
    up.wait_up()
    for seq in range(5):
        payload = Payload(PayloadType.RSSI, 3, seq, 1000, (RssiRecord(1, 7, -60),))
        says = encode_line(Report(payload)) if protocol == 'ascii' else c.MtAppRsp(0xE8, encode_payload(payload))
        sink.say(b'text\r\n', says)
    up.wait_seqs(range(5))
    assert sink.asked == []


def test_fault_of_the_host_does_not_end_the_link(sink, link):
    def wake():
        raise RuntimeError('a fault of the host')

    session = Session(LinkConfig(port=str(link), timeout=FAST), wake)
    session.start()
    with contextlib.closing(session):
        sink.wait_asked(c.ZdoExtNwkInfo)
    assert [item for item, _ in session.inbox.take()] == [LinkEvent('opened', sink.device), LinkEvent('up')]
    assert session.counters['internal_errors'] == 2


def test_fault_of_ours_opens_the_port_again(sink, host, monkeypatch):
    faults = iter([RuntimeError('a fault of ours')])

    def attach(*arguments):
        for fault in faults:
            raise fault
        return real(*arguments)

    real = session_module.attach
    monkeypatch.setattr(session_module, 'attach', attach)
    up = host()
    up.wait_up()
    assert (up.counted('internal_errors'), up.counted('opened')) == (1, 2)


def test_session_can_be_closed_twice_and_gives_the_port_back(sink, host):
    up = host()
    up.wait_up()
    up.session.close()
    up.session.close()
    open_port(str(sink.link), 115200, 1.0).close()
    assert up.session.status.phase == 'closed'
