"""sensing_node: signal strengths in, triggered ranges and trigger reports out, for one node id or many."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wsn_tracking_msgs import msg

from wsn_tracking.models.anchors import Anchors
from wsn_tracking.node_parameters.sensing import SensingNodeConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.assembly import Assembly
from wsn_tracking.nodes.base import TrackingNode, run
from wsn_tracking.sensing.channel_file import calibrated, check_channel
from wsn_tracking.sensing.stage import SensingStage
from wsn_tracking.sensing.values import Epoch, EpochEnd, Reason


class SensingNode(TrackingNode[SensingNodeConfig]):
    """Feeds a SensingStage with epochs and publishes what it sends."""

    def __init__(self) -> None:
        super().__init__('sensing_node', SensingNodeConfig)
        self.config.trigger.strategy()
        check_channel(self.config.channel)
        self._stage: SensingStage | None = None
        self._counts = {'sent': 0, 'offered': 0, 'dropped.invalid': 0}
        self._assembly = Assembly(self, self.config, self._sense, self._anew)
        self._range = self.give(msg.RangeMeasurement, 'range', qos.MEASUREMENTS)
        self._report = self.give(msg.TriggerReport, 'trigger_report', qos.MEASUREMENTS)
        self.take(msg.LocationRequest, 'request', convert.request_value, self._assembly.request, qos.MEASUREMENTS)
        self.take(msg.RssiMeasurement, 'rssi', convert.rssi_value, self._assembly.measurement, qos.MEASUREMENTS)
        self.take(msg.EpochEnd, 'epoch_end', convert.epoch_end_value, self._end, qos.MEASUREMENTS)
        self.take_anchors()

    def on_anchors(self, anchors: Anchors) -> None:
        """Make the stage."""
        radios, _ = calibrated(self.config.channel, anchors)
        self._stage = SensingStage(self.config.trigger, radios, self.config.ids, self.config.seed)
        self._assembly.start(anchors, self._stage.anchors.ids.tolist())

    def is_prepared(self) -> bool:
        """Whether the anchors are held."""
        return self._stage is not None

    def _end(self, end: EpochEnd, now: float) -> None:
        self._assembly.end(end, now, lists=end.topic == 'rssi')

    def _sense(self, epoch: Epoch) -> None:
        assert self._stage is not None  # the assembly starts with it
        sensed = self._stage.step(epoch)
        for r in sensed.ranges:
            self._range.publish(convert.range_message(r))
        self._report.publish(convert.report_message(sensed.report))
        self._counts['sent'] += len(sensed.ranges)
        self._counts['offered'] += len(epoch.measurements)
        self._counts['dropped.invalid'] += sum(reason == Reason.INVALID for reason in sensed.report.reasons)
        if epoch.request_seq == self._assembly.final_seq:
            self.ended = True
            self.report()

    def _anew(self) -> None:
        if self._stage is not None:
            self._stage.reset()
        self._counts = dict.fromkeys(self._counts, 0)

    def state(self) -> Mapping[str, Any]:
        """Counts of what was heard and sent, and what is waited for."""
        return {
            'system': 'random_q',
            'epoch': self._assembly.last_seq,
            'waits for': self.waits_for or self._assembly.waits_for,
            **self._counts,
            **self._assembly.counters,
        }


def main() -> None:
    """Run the node."""
    run(SensingNode)
