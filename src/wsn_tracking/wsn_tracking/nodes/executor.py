"""An executor for nodes that live on many small messages.

rclpy's own rebuilds its wait set and makes a task for every message, which costs more than our callbacks do. This
one keeps the wait set and drains a subscription that is ready. It knows subscriptions and timers; everything
else (parameter services, events, guards) it hands to the stock executor, whose promises stay: one callback at a
time, exceptions end the spin. It uses private parts of rclpy: where they are not as expected, `make_executor`
gives the stock one.
"""

from __future__ import annotations

import time
from typing import Any

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node

DRAIN = 200  # messages of one topic before others have their turn
STOCK_PERIOD = 1.0  # [s] at most between two looks at what only the stock executor knows


class DrainingExecutor(SingleThreadedExecutor):
    """Spins one node."""

    def __init__(self, node: Node) -> None:
        super().__init__(context=node.context)
        self.add_node(node)
        self._spun = node
        self._known: tuple[int, ...] = ()
        self._wait_set: Any = None

    def spin(self) -> None:
        """Run callbacks until the context is shut down, or a callback raises."""
        looked = 0.0
        while True:
            ready, needs_stock = self._wait()
            if not self._context.ok():
                raise ExternalShutdownException
            self._run_timers()
            for subscription in ready:
                _drain(subscription)
            now = time.monotonic()
            if needs_stock or now - looked > STOCK_PERIOD:
                looked = now
                self.spin_once(timeout_sec=0.0)

    def _wait(self) -> tuple[list[Any], bool]:
        """Wait until something is ready: the subscriptions, and whether the stock executor is needed."""
        node = self._spun
        subscriptions, timers = list(node.subscriptions), list(node.timers)
        services, guards = list(node.services), [*node.guards, self._guard, self._sigint_gc]
        counts = (len(subscriptions), len(guards), len(timers), len(services))
        if counts != self._known:  # endpoints came or went
            self._known = counts
            self._wait_set = _rclpy.WaitSet(counts[0], counts[1], counts[2], 0, counts[3], 0, self._context.handle)
        wait_set = self._wait_set
        wait_set.clear_entities()
        for subscription in subscriptions:
            wait_set.add_subscription(subscription.handle)
        for guard in guards:
            wait_set.add_guard_condition(guard.handle)
        for timer in timers:
            wait_set.add_timer(timer.handle)
        for service in services:
            wait_set.add_service(service.handle)
        wait_set.wait(int(STOCK_PERIOD * 1e9))
        pointers = set(wait_set.get_ready_entities('subscription'))
        ready = [subscription for subscription in subscriptions if subscription.handle.pointer in pointers]
        triggered = set(wait_set.get_ready_entities('guard_condition'))
        for guard in node.guards:  # a wait takes the trigger away: the stock executor would not see it
            if guard.handle.pointer in triggered:
                guard.callback()
        needs_stock = bool(wait_set.get_ready_entities('service') or wait_set.get_ready_entities('guard_condition'))
        return ready, needs_stock

    def _run_timers(self) -> None:
        for timer in list(self._spun.timers):
            if _is_due(timer):
                timer.callback()


def _is_due(timer: Any) -> bool:
    """Whether a timer is to be called now; if so, its next period begins."""
    try:
        with timer.handle:
            due: bool = timer.handle.is_timer_ready()
            if due:
                timer.handle.call_timer()
    except _rclpy.InvalidHandle:  # the callback of another has destroyed it
        return False
    return due


def _drain(subscription: Any) -> None:
    """Run the callback for what has arrived."""
    for _ in range(DRAIN):
        try:
            with subscription.handle:
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        except _rclpy.InvalidHandle:  # a callback has destroyed it
            return
        if taken is None:
            return
        subscription.callback(taken[0])


def make_executor(node: Node) -> SingleThreadedExecutor:
    """The draining executor, or the stock one where this rclpy has other private parts."""
    if not node.context.ok():
        raise ExternalShutdownException  # told to end before it began
    try:
        executor = DrainingExecutor(node)
        known = (executor._guard, executor._sigint_gc, executor._context)  # noqa: SLF001
        handles = [*(type(s.handle) for s in node.subscriptions), *(type(t.handle) for t in node.timers)]
        usable = (
            all(part is not None for part in known)
            and all(hasattr(kind, 'pointer') for kind in handles)
            and all(hasattr(type(t.handle), 'call_timer') for t in node.timers)
            and hasattr(_rclpy.WaitSet, 'clear_entities')
        )
    except (AttributeError, TypeError):
        usable = False
    if usable:
        return executor
    stock = SingleThreadedExecutor(context=node.context)
    stock.add_node(node)
    return stock
