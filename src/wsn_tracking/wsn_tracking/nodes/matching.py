"""Whether a node's inputs and outputs are matched with those that the graph promises."""

from __future__ import annotations

from typing import TypeVar

from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

from wsn_tracking.errors import TrackingError
from wsn_tracking.node_parameters.common import NodeConfig

End = TypeVar('End', Publisher, Subscription)


class Matching:
    """Counts matched partners of a node's endpoints, both ways: a partner that was only seen is not matched yet."""

    def __init__(self, config: NodeConfig) -> None:
        self._wanted_subscribers = _counts(config.expected_subscribers, 'expected_subscribers')
        self._wanted_publishers = _counts(config.expected_publishers, 'expected_publishers')
        self._publishers: dict[str, Publisher] = {}
        self._subscriptions: dict[str, Subscription] = {}

    def publisher(self, publisher: Publisher, topic: str) -> Publisher:
        """Remember an output."""
        self._publishers[topic] = publisher
        return publisher

    def subscription(self, subscription: Subscription, topic: str) -> Subscription:
        """Remember an input."""
        self._subscriptions[topic] = subscription
        return subscription

    def complete(self) -> bool:
        """Whether all that was promised is there."""
        return not self.missing()

    def missing(self) -> str:
        """What is not there yet, in words."""
        parts = []
        for topic, wanted in self._wanted_subscribers.items():
            publisher = self._publishers.get(topic)
            if publisher is not None and (seen := publisher.get_subscription_count()) < wanted:
                parts.append(f'{seen} of {wanted} subscribers of {topic}')
        for topic, wanted in self._wanted_publishers.items():
            subscription = self._subscriptions.get(topic)
            if subscription is not None and (seen := subscription.get_publisher_count()) < wanted:
                parts.append(f'{seen} of {wanted} publishers of {topic}')
        return ', '.join(parts)


def _counts(entries: tuple[str, ...], name: str) -> dict[str, int]:
    counts = {}
    for entry in filter(None, entries):
        topic, separator, count = entry.rpartition('=')
        if not separator or not count.isdecimal():
            raise TrackingError(f'parameter `{name}` holds {entry!r}: expected topic=count')
        counts[topic] = int(count)
    return counts
