"""Messages down to nodes: sent, confirmed, tried twice, never more than two at a time."""

import dataclasses

import pytest
from fake_sink import PATIENCE, script
from session_cases import FAST, FEEDBACK

from wsn_tracking.zstack import commands as c


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
