"""Hosts of this project on a simulated sink where nothing goes wrong (what can: test_sink_line.py)."""

from __future__ import annotations

import pytest
from sink_cases import epochs, expected

from radio import until
from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.settings import FormConfig

WORLD = epochs(12, nodes=6)
RATE = 60.0


@pytest.fixture
def sink(radio):
    """Starts sinks that tell of this world."""
    return lambda world=WORLD, **config: radio(world, **{'rate': RATE, **config})


@pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
def test_host_attaches_writes_nothing_and_gets_everything(sink, host, flavour):
    radio = sink(flavour=flavour)
    before = radio.simulator.device.chip.memory.content
    heard = host().through(radio)
    assert heard.measured == expected(WORLD)
    counters = heard.session.counters
    assert (counters['attached'], counters['lost'], counters['rpc_errors']) == (1, 0, 0)
    assert heard.session.status.sink.version.product == {'home_1_2': 0, 'zstack_3_0': 2}[flavour]
    assert radio.simulator.device.chip.memory.content == before


@pytest.mark.parametrize('flavour', ['home_1_2', 'zstack_3_0'])
def test_host_forms_a_network(sink, host, flavour):
    radio = sink(flavour=flavour, formed=False)
    confirm = f'{radio.simulator.device.chip.memory.ieee:016x}'
    heard = host(form=FormConfig(confirm, 20, 0x1234)).through(radio)
    assert heard.measured == expected(WORLD)
    network = heard.session.status.network
    assert (network.channel, network.pan_id) == (20, 0x1234)


def test_nothing_is_said_before_it_may_begin(sink, host):
    radio = sink()
    heard = host()
    until(lambda: heard.events('up') and radio.simulator.counters['requests'] > 8, 'pings')
    assert heard.measured == []
    assert radio.simulator.sent == []
    assert heard.through(radio).measured == expected(WORLD)


def test_host_can_speak_to_the_nodes(sink, host):
    radio = sink(world=[])
    heard = host()
    heard.until_up()
    radio.may_begin.set()
    until(lambda: radio.loop.begun is not None, 'the beginning')
    heard.session.ask(c.ZdoMgmtLqiReq(0, 0), c.ZdoMgmtLqiReqRsp)
    until(lambda: heard.take() or any(isinstance(i, c.ZdoMgmtLqiRsp) for i, _ in heard.received), 'its neighbours')
