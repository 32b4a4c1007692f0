"""A sink that restarts, falls silent or forgets is found out, and nothing that it said is lost."""

import dataclasses

from fake_sink import registering, script
from session_cases import FAST, IMPATIENT, data

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.reports import Report


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


def test_silent_sink_is_pinged_and_kept(sink, host):
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.wait_asked(c.SysPing, 5)
    assert up.counted('lost') == 0


def test_restart_of_which_the_line_told_nothing_is_found_out(sink, host):
    """The sink's word was lost: it answers pings, its network is down, and it has forgotten our endpoint."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    forgetful = script()
    forgetful[c.UtilGetDeviceInfo] = lambda asked: script(9 if sink.questions(c.ZdoStartup) else 0)[type(asked)]
    forgetful[c.ZdoExtNwkInfo] = [data(0), *forgetful[c.ZdoExtNwkInfo]]
    sink.answers = forgetful
    sink.wait_asked(c.ZdoStartup)
    up.wait_up(2)
    assert (up.counted('resets'), up.counted('found_down'), up.counted('lost')) == (0, 1, 0)
    kinds = [getattr(r.item, 'kind', type(r.item).__name__) for r in up.received]
    assert kinds == ['opened', 'up', 'restarted', 'ZdoStateChangeInd', 'ZdoStateChangeInd', 'Report', 'up']


def test_sink_that_came_back_by_itself_and_has_forgotten_us_is_found_out(sink, host):
    """Its network is up again, so that nothing but our endpoint is missing."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.answers[c.AfRegister] = registering()
    up.wait_up(2)
    sink.wait_asked(c.SysPing, len(sink.questions(c.SysPing)) + 3)
    assert (up.counted('found_down'), up.counted('attached'), up.counted('lost')) == (1, 2, 0)
    assert not sink.questions(c.ZdoStartup)


def test_sink_that_calls_our_endpoint_new_whenever_it_is_asked_has_forgotten_nothing(sink, host):
    sink.answers[c.AfRegister] = [c.AfRegisterRsp(0)]
    up = host(timeout=dataclasses.replace(FAST, idle=0.05))
    up.wait_up()
    sink.wait_asked(c.AfRegister, 7)  # once when it is attached, twice at each of three pings
    assert (up.counted('found_down'), up.counted('attached'), up.counted('lost')) == (0, 1, 0)


def test_sink_that_is_busy_is_asked_again_and_not_attached_anew(sink, host):
    """It answers pings, and nothing else for a while."""
    up = host(timeout=dataclasses.replace(FAST, idle=0.05, reply=0.05))
    up.wait_up()
    for busy in (c.AfRegister, c.UtilGetDeviceInfo):
        sink.answers = {**sink.answers, busy: []}
        sink.wait_asked(busy, len(sink.questions(busy)) + 3)
    assert (up.counted('found_down'), up.counted('attached'), up.counted('lost')) == (0, 1, 0)
    assert not sink.questions(c.ZdoStartup)


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
