from wsn_tracking.zstack.commands import AfDataConfirm
from wsn_tracking.zstack.counters import new_counters
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.queues import Inbox, Outbox, Outgoing, Received
from wsn_tracking.zstack.settings import TimeoutConfig


def outbox(capacity=10):
    counters = new_counters()
    return Outbox(Radio(), capacity, TimeoutConfig(confirm=5.0, send_age=2.0), counters), counters


def test_inbox_drops_the_oldest_and_counts():
    counters = new_counters()
    inbox = Inbox(3, counters)
    for k in range(5):
        inbox.put(Received(k, k))
    assert [item for item, _ in inbox.take()] == [2, 3, 4]
    assert inbox.take() == []
    assert inbox.take(0.001) == []
    assert counters['host_queue_dropped'] == 2


def test_at_most_two_are_on_their_way():
    box, _ = outbox()
    for k in range(4):
        box.put(Outgoing(k, b'', 0.0))
    first, second = box.due(0.0), box.due(0.0)
    assert (first.dst, second.dst, box.due(0.0)) == (0, 1, None)
    box.confirm(AfDataConfirm(0, 0xE8, second.trans_id))
    assert box.due(0.0).dst == 2


def test_overdue_confirmation_repeats_once_and_then_gives_up():
    box, counters = outbox()
    box.put(Outgoing(7, b'x', 0.0))
    first = box.due(0.0)
    assert box.deadline == 5.0
    assert box.due(4.9) is None
    again = box.due(5.0)
    assert (again.dst, again.data) == (7, b'x')
    assert again.trans_id != first.trans_id
    assert box.due(10.0) is None
    assert box.deadline == float('inf')
    assert [counters[n] for n in ('sent', 'send_repeated', 'send_failed', 'confirms_missing')] == [2, 1, 1, 2]


def test_confirmation_of_nothing_is_counted():
    box, counters = outbox()
    box.confirm(AfDataConfirm(0, 0xE8, 9))
    box.failed(9)
    assert counters['confirms_unknown'] == 1
    assert counters['send_failed'] == 0


def test_repeated_message_goes_before_the_next():
    box, _ = outbox()
    box.put(Outgoing(1, b'', 0.0))
    first = box.due(0.0)
    box.put(Outgoing(2, b'', 0.0))
    box.confirm(AfDataConfirm(0xE9, 0xE8, first.trans_id))
    assert [box.due(0.0).dst, box.due(0.0).dst] == [1, 2]


def test_numbers_of_messages_are_a_byte_and_never_zero():
    box, counters = outbox()
    numbers = set()
    for _ in range(600):
        box.put(Outgoing(1, b'', 0.0))
        sent = box.due(0.0)
        numbers.add(sent.trans_id)
        box.confirm(AfDataConfirm(0, 0xE8, sent.trans_id))
    assert numbers == set(range(1, 256))
    assert counters['confirmed'] == 600


def test_message_that_waited_too_long_is_dropped_and_counted():
    box, counters = outbox()
    for k in range(3):
        box.put(Outgoing(k, b'', float(k)))
    assert box.due(3.5).dst == 2
    assert box.due(3.5) is None
    assert counters['send_expired'] == 2
