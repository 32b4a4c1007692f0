"""Faults of the sink itself: resets, plugs, silence, and answers that are missing, late or refusals."""

from fault_cases import WORLD
from sink_cases import Host

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.outlet import Plug


def test_reset_in_mid_run_silences_it_until_it_is_registered_again():
    host = Host(WORLD, faults=('reset=5',))
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 9.5)
    assert len(host.of(c.SysResetInd)) == 1
    assert {r.payload.seq for r in host.reports} == set(range(5))
    host.attach()
    host.until(host.now + 30.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(10, 30)}


def test_unplugged_sink_comes_back_as_after_power_up():
    host = Host(WORLD, faults=('unplug=5',), fault_time=3.0)
    host.attach()
    host.simulator.begin(host.now)
    begun = host.now
    host.until(begun + 8.5)
    assert [item for item in host.items if isinstance(item, Plug)] == [Plug.IN, Plug.OUT, Plug.IN]
    assert host.items[-1] == c.SysResetInd(0, 2, 0, 2, 6, 3)
    host.attach()
    host.until(begun + 40.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(9, 30)}
    assert host.simulator.finished


def test_mute_sink_is_deaf_too_and_forgets_nothing():
    host = Host(WORLD, faults=('mute=5',), fault_time=3.0)
    host.attach()
    host.simulator.begin(host.now)
    host.until(host.now + 6.0)
    said = len(host.items)
    host.say(c.SysPing())
    host.until(host.now + 1.0)
    assert len(host.items) == said
    host.until(host.now + 30.0)
    assert {r.payload.seq for r in host.reports} == {*range(5), *range(8, 30)}
    host.say(c.SysPing())
    assert host.items[-1] == c.SysPingRsp(0x0179)


def test_refused_requests_are_not_done():
    host = Host(faults=('rpc_error=1',))
    host.attach()
    assert host.of(c.RpcError) == [c.RpcError(2, 0x25, 0x40), c.RpcError(2, 0x24, 0x00)]
    assert not host.simulator.delivers


def test_sink_without_network_information_delivers_all_the_same():
    host = Host(faults=('no_network_info',))
    host.attach()
    host.say(c.ZdoExtNwkInfo(), c.SysPing())
    assert host.items[-2:] == [c.RpcError(2, 0x25, 0x50), c.SysPingRsp(0x0179)]
    assert host.simulator.delivers


def test_missing_answers_were_given_all_the_same():
    host = Host(faults=('missing_reply=1',))
    host.attach()
    assert host.simulator.delivers
    assert [type(item) for item in host.items[1:]] == [c.ZdoStateChangeInd]


def test_late_answers_come_late():
    host = Host(faults=('late_reply=1',), fault_time=4.0)
    host.until(host.now)
    asked_at = host.now
    host.say(c.SysPing())
    host.until(asked_at + 3.9)
    assert host.of(c.SysPingRsp) == []
    host.until(asked_at + 4.1)
    assert len(host.of(c.SysPingRsp)) == 1
