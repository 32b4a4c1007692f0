"""A host attaches to a formed network, whatever the sink answers, and writes nothing to its memory."""

import dataclasses
import time

import pytest
from fake_sink import IEEE, PATIENCE, script
from session_cases import FAST, WRITES, data

from wsn_tracking.zstack import commands as c


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
    host(timeout=dataclasses.replace(FAST, reply=0.05, commissioning=10 * PATIENCE)).wait_up()


def test_answer_to_starting_the_network_may_be_lost_where_its_state_is_told(sink, host):
    sink.answers = script(state=0)
    sink.answers[c.ZdoStartup] = [c.ZdoStateChangeInd(9)]
    up = host()
    up.wait_up()
    assert (up.counted('no_answers'), up.counted('opened')) == (1, 1)


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


def test_reset_while_attaching_begins_again(sink, host):
    def first_time(asked):
        first = len(sink.questions(c.AfRegister)) == 1
        return [c.SysResetInd(0, 2, 0, 2, 6, 3)] if first else [c.AfRegisterRsp(0)]

    sink.answers[c.AfRegister] = first_time
    up = host()
    up.wait_up()
    assert (len(sink.questions(c.AfRegister)), up.counted('open_failed'), up.counted('opened')) == (2, 0, 1)
