"""A feed of the test's own: it sends the values of a recording as the nodes of this project do."""

from __future__ import annotations

from typing import Any

from wsn_tracking_msgs import msg

from observer import Observer
from wsn_tracking.nodes import convert, qos
from wsn_tracking.sensing.recording import Message, Recording, epoch_key
from wsn_tracking.sensing.values import EpochEnd, Range, RangeBearing, Request, Rssi

TOPICS: dict[type[Any], tuple[str, type[Any], Any]] = {
    Request: ('request', msg.LocationRequest, convert.request_message),
    Rssi: ('rssi', msg.RssiMeasurement, convert.rssi_message),
    Range: ('range', msg.RangeMeasurement, convert.range_message),
    RangeBearing: ('observation', msg.RangeBearing, convert.range_bearing_message),
    EpochEnd: ('epoch_end', msg.EpochEnd, convert.epoch_end_message),
}


class Feed:
    """Publishes requests, measurements of one kind, ends of epochs and, at once, the anchors."""

    def __init__(self, observer: Observer, anchors: Any, kind: type[Any]) -> None:
        self._observer = observer
        node = observer.node
        self._outputs = {
            of: node.create_publisher(TOPICS[of][1], TOPICS[of][0], qos.MEASUREMENTS)
            for of in (Request, kind, EpochEnd)
        }
        table = node.create_publisher(msg.Anchors, 'anchors', qos.LATCHED_LAST)
        table.publish(convert.anchors_message(anchors, 0))

    def until_heard(self, timeout: float, **listeners: int) -> None:
        """Until so many nodes listen to a topic; one where nothing else is said."""
        for kind, output in self._outputs.items():
            topic = TOPICS[kind][0]
            wanted = listeners.get(topic, 1)
            self._observer.until(
                lambda output=output, wanted=wanted: output.get_subscription_count() == wanted,
                timeout,
                f'{topic} is heard by {wanted}',
            )

    def send(self, *values: Message) -> None:
        """In this order, each on the topic of its kind."""
        for value in values:
            self._outputs[type(value)].publish(TOPICS[type(value)][2](value))


def first_epochs(recording: Recording, epochs: int) -> Recording:
    """The first epochs of every target of a recording, the last of them final."""
    kept = [m for m in recording.messages if epoch_key(m)[1] < epochs]
    last = {m.target_id: i for i, m in enumerate(kept) if isinstance(m, EpochEnd)}
    for i in last.values():
        kept[i] = kept[i]._replace(final=True)
    return recording._replace(messages=tuple(kept))
