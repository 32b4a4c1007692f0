"""A network is formed only where it was asked for and confirmed, as the firmware wants it."""

import dataclasses

import pytest
from fake_sink import IEEE, script
from session_cases import FAST, WRITES

from wsn_tracking.zstack import commands as c
from wsn_tracking.zstack.settings import FormConfig


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


def test_network_that_a_sink_remembers_is_not_formed_again_when_it_restarts(sink, host):
    """It is down until it is started, and tells nothing of it before."""
    sink.answers = script(state=0)
    sink.answers[c.ZdoExtNwkInfo] = lambda asked: [
        c.ZdoExtNwkInfoRsp(0, 9, 0x1A63, 0, 1, 0, 15) if sink.questions(c.ZdoStartup) else c.RpcError(2, 0x25, 0x50)
    ]
    up = host(**forming())
    up.wait_up()
    assert not sink.questions(WRITES)


def test_network_is_formed_once(sink, host):
    """Also where the sink never tells which network it has: what comes after a replug is attached to."""
    sink.answers[c.ZdoExtNwkInfo] = [c.RpcError(2, 0x25, 0x50)]
    up = host(**forming())
    up.wait_up()
    sink.unplug()
    up.until(lambda: up.events('lost'))
    sink.plug()
    up.wait_up(2)
    assert len(sink.questions(c.SysResetReq)) == 1


def test_forming_that_fails_is_not_tried_for_ever(sink, host):
    sink.answers = script(product=2)
    sink.answers[c.BdbStartCommissioning] = [c.BdbStartCommissioningRsp(1)]
    up = host(**forming())
    up.until(lambda: 'nothing more is erased' in up.session.status.error)
    assert len(sink.questions(c.SysResetReq)) == FAST.tries


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
