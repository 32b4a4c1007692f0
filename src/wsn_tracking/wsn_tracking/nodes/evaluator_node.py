"""evaluator_node: scores estimates against the truth while they come, and prints the table when the feed ends."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from wsn_tracking_msgs import msg

from wsn_tracking.evaluation.compared import fused_by
from wsn_tracking.evaluation.report_json import write_json
from wsn_tracking.evaluation.score import Score, score
from wsn_tracking.evaluation.summary import Summary, traffic
from wsn_tracking.evaluation.table import format_table, wants_colour
from wsn_tracking.models.anchors import Floats
from wsn_tracking.node_parameters.listeners import EvaluatorConfig
from wsn_tracking.nodes import convert, qos
from wsn_tracking.nodes.base import Finished, TrackingNode, run
from wsn_tracking.nodes.dropped import dropped_input
from wsn_tracking.nodes.health import Health, truth, worst
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.sensing.values import EpochEnd, TriggerReport
from wsn_tracking.streams import give_up_output
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.fusing import compared

SHARE_OF_TIME = 0.05  # that scores for /diagnostics may take: every epoch so far is in each of them
QUIET = 4  # looks in a row without a message before the end is believed


def _track(target: int, poses: Sequence[tuple[int, Floats, Floats]]) -> Truth:
    stamps, first = np.unique(np.array([stamp for stamp, _, _ in poses], dtype=np.int64), return_index=True)
    positions = np.array([position for _, position, _ in poses])[first]
    velocities = np.array([velocity for _, _, velocity in poses])[first]
    return Truth(target, stamps, positions, velocities)


class EvaluatorNode(TrackingNode[EvaluatorConfig]):
    """Collects the targets' truth and estimates; ends with the feed."""

    def __init__(self) -> None:
        super().__init__('evaluator_node', EvaluatorConfig)
        config = self.config
        self._estimates: dict[str, list[Estimate]] = {name: [] for name in config.outputs if name}
        self._locals = [name for name in self._estimates if name.startswith('local_')]
        self._compared = compared(config.fusion) if len(self._locals) > 1 else ()
        self._truth: dict[int, list[tuple[int, Floats, Floats]]] = {target: [] for target in config.targets}
        self._reports: list[TriggerReport] = []
        # Stamps and numbers of the epochs: a target that was restarted, or a looped bag, has the same number again.
        self._ends: dict[int, list[tuple[int, int]]] = {target: [] for target in config.targets}
        self._finals: dict[int, int] = {}  # the last epoch of each target
        self._last = time.monotonic()
        self._told: dict[str, dict[str, str]] = {}
        self._heard, self._seen, self._quiet = 0, 0, 0  # messages of the targets that are scored
        self._running: dict[str, str] = {}
        self._score_at = 0.0  # steady time from which on they are computed anew
        for name in self._estimates:
            self._take_output(name)
        self.take(msg.EpochEnd, 'epoch_end', convert.epoch_end_value, self._end, qos.MEASUREMENTS)
        self.take(msg.TriggerReport, 'trigger_report', convert.report_value, self._reported, qos.MEASUREMENTS)
        for target, poses in self._truth.items():
            self._take_truth(target, poses)
        self.create_subscription(DiagnosticArray, '/diagnostics', self._diagnosed, qos.ESTIMATES)
        self.take_anchors()
        self.create_timer(0.05, self._finish)

    def is_prepared(self) -> bool:
        """Whether the anchors are held."""
        return self.anchors is not None

    def _take_output(self, name: str) -> None:
        def heard(estimate: Estimate, now: float) -> None:
            if estimate.target_id in self._ends:
                self._last = now
                self._heard += 1
                self._estimates[name].append(estimate)

        self.take(msg.TargetEstimate, f'estimate/{name}', convert.estimate_value, heard, qos.FED)

    def _take_truth(self, target: int, poses: list[tuple[int, Floats, Floats]]) -> None:
        def heard(pose: tuple[int, Floats, Floats], now: float) -> None:
            self._heard += 1
            poses.append(pose)

        self.take(Odometry, f'truth/target_{target}', convert.truth_position, heard, qos.FED)

    def _end(self, end: EpochEnd, now: float) -> None:
        if end.target_id in self._ends:
            self._last = now
            self._heard += 1
            ends, epoch = self._ends[end.target_id], (end.stamp_ns, end.request_seq)
            if ends[-1:] != [epoch]:
                ends.append(epoch)
            if end.final:
                self._finals[end.target_id] = end.request_seq
            self.ended = len(self._finals) == len(self._ends)

    def _reported(self, report: TriggerReport, now: float) -> None:
        if report.target_id in self._ends:
            self._heard += 1
            self._reports.append(report)

    def _diagnosed(self, array: DiagnosticArray) -> None:
        for status in array.status:
            namespace, _, name = status.name.rpartition('/')
            if (namespace or '/') == self.get_namespace():  # /diagnostics has those of other graphs as well
                self._told[name] = {pair.key: pair.value for pair in status.values}

    def _finish(self) -> None:
        """The feed has ended: wait for the last outputs and counts, at most `output_timeout`, and tell.

        Quiet is measured in looks at the queues, not in time: a process that was held up has not looked. Messages of
        targets that are not scored may go on for ever.
        """
        self._quiet = self._quiet + 1 if self._heard == self._seen else 0
        self._seen = self._heard
        if not self.ended or self._quiet < QUIET:
            return
        missing = [name for name, e in self._estimates.items() if not e or not self._is_final(e[-1])]
        finals = {str(seq) for seq in self._finals.values()}
        reports = filter(None, self.config.expected_reports)
        untold = [name for name in reports if self._told.get(name, {}).get('epoch') not in finals]
        if (missing or untold) and time.monotonic() - self._last < self.config.output_timeout:
            return
        for name in missing:
            self.get_logger().warn(f'estimate/{name} did not reach the final epoch of its target: {self._finals}')
        self._tell()
        raise Finished(1 if missing else 0)

    def _is_final(self, estimate: Estimate) -> bool:
        return estimate.request_seq == self._finals[estimate.target_id]

    def _tell(self) -> None:
        summary = self._summary()
        try:
            print(format_table(summary, colour=wants_colour(sys.stdout)), flush=True)
        except BrokenPipeError:
            give_up_output()
        if self.config.json:
            write_json(self.config.json, summary)
        if self.config.plot:
            self._draw()

    def _draw(self) -> None:
        from wsn_tracking.evaluation.plots import plot_all  # matplotlib is slow to import, and seldom asked for

        assert self.anchors is not None
        estimates = {name: e for name, e in self._every_output().items() if e}
        plot_all(self.config.plot, self.anchors, self._tracks(), estimates, title=self.config.title)

    def _tracks(self) -> dict[int, Truth]:
        """Where the targets really were, by target."""
        return {target: _track(target, poses) for target, poses in self._truth.items() if poses}

    def _every_output(self) -> dict[str, list[Estimate]]:
        """The outputs; behind those of system A what the mean and LCI make of the locals of each epoch."""
        own = {name: e for name, e in self._estimates.items() if name.startswith(('local_', 'fused_'))}
        every = {**own}
        for fuser in self._compared:
            every[fuser.source] = fused_by(fuser, [self._estimates[name] for name in self._locals])
        return {**every, **self._estimates}

    def _summary(self) -> Summary:
        tracks = self._tracks()
        starts = {target: ends[0][0] if ends else 0 for target, ends in self._ends.items()}
        scores: dict[str, Score] = {}
        for name, estimates in self._every_output().items():
            track = tracks.get(estimates[0].target_id) if estimates else None
            if track is not None:
                scores[name] = score(estimates, track, self.config.skip, start_ns=starts[track.target_id])
        return Summary(
            self.config.title,
            next(iter(self._ends)) if len(self._ends) == 1 else None,
            sum(map(len, self._ends.values())),
            scores,
            dropped_input(self._told.values(), several_targets=len(self._ends) > 1),
            traffic(self._reports),
            self.config.skip,
        )

    def health(self) -> Health:
        """Requests that stopped, estimates that cannot be scored."""
        heard, told = (sum(map(len, held.values())) for held in (self._estimates, self._truth))
        return worst(super().health(), truth(heard, told))

    def state(self) -> Mapping[str, Any]:
        """Running RMSE and NEES of every output: not so often, in a long run, that they cost much of the time."""
        began = time.monotonic()
        if began >= self._score_at:
            outputs, share = self._summary().outputs, traffic(self._reports).share
            scores = {name: {'rmse_m': f'{s.rmse_m:.4f}', 'nees': f'{s.nees:.2f}'} for name, s in outputs.items()}
            self._running = {f'{name}.{what}': value for name, told in scores.items() for what, value in told.items()}
            self._running['share sent'] = f'{share:.3f}'
            self._score_at = began + (time.monotonic() - began) / SHARE_OF_TIME
        return {**self._running, 'epochs': sum(map(len, self._ends.values()))}


def main() -> None:
    """Run the node."""
    run(EvaluatorNode)
