"""A recording through trackers that need no peers, one a target, without any middleware."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from wsn_tracking.evaluation.run import Progress, Run, Span, silent, told, watched_epochs
from wsn_tracking.sensing.recording import Recording, of_target
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.tracker import Tracker


def run_trackers(recording: Recording, trackers: Mapping[int, Tracker], progress: Progress = silent) -> Run:
    """Every target's epochs through its tracker: a target's estimates do not depend on who else is there."""
    estimates: dict[str, list[Estimate]] = {}
    counters: Counter[str] = Counter(recording.dropped)
    spans: dict[int, Span] = {}
    for target, tracker in trackers.items():
        own = of_target(recording, target)._replace(dropped={})
        heard: Counter[str] = Counter()
        for epoch in watched_epochs(own, target, heard, spans, tracker.reset, progress):
            for estimate in tracker.step(epoch):
                estimates.setdefault(estimate.source, []).append(estimate)
        counters.update(heard)
        counters['gated'] += tracker.counters['gated']  # all else that it drops was counted with its epoch
    return Run({name: tuple(e) for name, e in estimates.items()}, (), spans, told(counters))
