"""The draining executor does what the stock one does: every promise is held against both."""

from __future__ import annotations

import contextlib
import threading
import time

import pytest
import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from std_msgs.msg import Int64

import live
from wsn_tracking.nodes import executor as ours
from wsn_tracking.nodes import qos

TIMEOUT = 60.0  # [s]


def stock(node):
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    return executor


@pytest.fixture
def pair():
    """A node under test and one that talks to it, in a domain of their own."""
    context = Context()
    with live.private_domain() as environment:
        rclpy.init(context=context, domain_id=int(environment['ROS_DOMAIN_ID']))
        nodes = [rclpy.create_node(name, context=context) for name in ('spun', 'talker')]
        yield nodes
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown(context=context)


class Done(Exception):
    pass


def guarded(node):
    """Nothing waits for ever: a timer ends a spin that lasts too long."""
    node.create_timer(TIMEOUT, lambda: pytest.fail('the spin has not ended'))


EXECUTORS = pytest.mark.parametrize('make', [ours.DrainingExecutor, stock], ids=['draining', 'stock'])


@EXECUTORS
def test_every_message_comes_once_and_in_the_order_of_its_topic(pair, make):
    node, talker = pair
    count, heard = 300, {'a': [], 'b': []}
    for topic, messages in heard.items():

        def hear(message, messages=messages):
            messages.append(message.data)
            if all(len(m) == count for m in heard.values()):
                raise Done

        node.create_subscription(Int64, topic, hear, qos.MEASUREMENTS)
    outputs = {topic: talker.create_publisher(Int64, topic, qos.MEASUREMENTS) for topic in heard}

    def talk():
        if all(p.get_subscription_count() for p in outputs.values()) and not timer.is_canceled():
            timer.cancel()
            for k in range(count):
                for p in outputs.values():
                    p.publish(Int64(data=k))

    timer = node.create_timer(0.01, talk)
    guarded(node)
    with pytest.raises(Done):
        make(node).spin()
    assert heard == {'a': list(range(count)), 'b': list(range(count))}


@EXECUTORS
def test_timers_run_as_often_as_they_should_beside_messages(pair, make):
    """A timer of 10 ms and one of 30 ms: three to one, whoever spins."""
    node, talker = pair
    ticks = {'fast': 0, 'slow': 0}

    def slow():
        ticks['slow'] += 1
        if ticks['slow'] == 20:
            raise Done

    def fast():
        ticks['fast'] += 1
        output.publish(Int64(data=ticks['fast']))

    output = talker.create_publisher(Int64, 'a', qos.MEASUREMENTS)
    node.create_subscription(Int64, 'a', lambda _: None, qos.MEASUREMENTS)
    node.create_timer(0.01, fast)
    node.create_timer(0.03, slow)
    guarded(node)
    with pytest.raises(Done):
        make(node).spin()
    assert 20 <= ticks['fast'] <= 3 * 20 + 2  # one that is held up skips beats, it does not make up for them


@EXECUTORS
def test_an_endpoint_that_is_added_or_removed_in_a_callback_counts(pair, make):
    node, talker = pair
    output = talker.create_publisher(Int64, 'late', qos.LATCHED)
    output.publish(Int64(data=7))

    def hear(message):
        assert message.data == 7
        raise Done

    def add():
        node.destroy_timer(timer)
        node.create_subscription(Int64, 'late', hear, qos.LATCHED)

    timer = node.create_timer(0.02, add)
    guarded(node)
    with pytest.raises(Done):
        make(node).spin()
    assert timer not in list(node.timers)


@EXECUTORS
def test_who_is_destroyed_in_the_callback_of_another_is_not_called(pair, make):
    """Messages wait on both topics, and timers are due, when the first callback takes all others away."""
    node, talker = pair
    called, made = [], []

    def end(message):
        called.append(message.data)
        for subscription in made[1:]:
            node.destroy_subscription(subscription)
        node.create_timer(0.05, done)

    def tick():
        called.append('tick')
        for timer in timers:
            node.destroy_timer(timer)

    def done():
        raise Done

    outputs = [talker.create_publisher(Int64, topic, qos.MEASUREMENTS) for topic in 'ab']
    made += [node.create_subscription(Int64, topic, end, qos.MEASUREMENTS) for topic in 'ab']
    end_of_patience = time.monotonic() + TIMEOUT
    while not all(output.get_subscription_count() for output in outputs):
        assert time.monotonic() < end_of_patience
    for output in outputs:
        output.publish(Int64(data=1))
        assert output.wait_for_all_acked(Duration(seconds=TIMEOUT))
    timers = [node.create_timer(0.0, tick) for _ in range(2)]
    guarded(node)
    with pytest.raises(Done):
        make(node).spin()
    assert called == ['tick', 1]


@EXECUTORS
def test_services_are_answered(pair, make):
    """What `ros2 param get` asks."""
    node, talker = pair
    node.declare_parameter('answer', 42)
    client = talker.create_client(GetParameters, 'spun/get_parameters')
    answered = []

    def ask():
        assert client.wait_for_service(TIMEOUT)
        future = client.call_async(GetParameters.Request(names=['answer']))
        other = stock(talker)
        other.spin_until_future_complete(future, TIMEOUT)
        answered.append(future.result().values[0].integer_value)

    asking = threading.Thread(target=ask)
    asking.start()

    def look():
        if answered or not asking.is_alive():
            raise Done

    node.create_timer(0.02, look)
    guarded(node)
    with pytest.raises(Done):
        make(node).spin()
    asking.join(TIMEOUT)
    assert answered == [42]


@EXECUTORS
def test_a_shutdown_from_elsewhere_ends_the_spin(pair, make):
    node, _ = pair
    executor = make(node)
    guarded(node)
    timer = threading.Timer(0.2, lambda: rclpy.shutdown(context=node.context))
    timer.start()
    with contextlib.suppress(ExternalShutdownException):
        executor.spin()
    timer.join(TIMEOUT)
    assert not node.context.ok()


def test_where_rclpy_has_other_private_parts_the_stock_executor_spins(pair, monkeypatch):
    node, _ = pair
    assert isinstance(ours.make_executor(node), ours.DrainingExecutor)
    monkeypatch.setattr(ours, '_rclpy', type('Other', (), {'WaitSet': type('WaitSet', (), {})}))
    fallback = ours.make_executor(node)
    assert type(fallback) is SingleThreadedExecutor
    assert node in fallback.get_nodes()
    monkeypatch.undo()

    def other(self, node):
        raise AttributeError('no such part')

    monkeypatch.setattr(ours.DrainingExecutor, '__init__', other)
    monkeypatch.setattr(ours.DrainingExecutor, '__del__', lambda self: None)
    assert type(ours.make_executor(node)) is SingleThreadedExecutor
