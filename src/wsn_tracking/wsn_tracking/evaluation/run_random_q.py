"""A recording through system A without any middleware: what the graph computes, estimator by estimator."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from typing import NamedTuple

from wsn_tracking.evaluation.run import Progress, Run, Span, silent, told, watched_epochs
from wsn_tracking.sensing.channel_file import calibrated
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import Epoch, TriggerReport
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator
from wsn_tracking.trackers.fusing import Fuser, compared
from wsn_tracking.trackers.random_q import LocalEstimator


class Sensing(NamedTuple):
    """Parameters of the sensing stage."""

    trigger: TriggerConfig
    seed: int
    channel: str = ''  # file of `calibrate`; empty: the anchors tell


def run_random_q(
    recording: Recording,
    sensing: Sensing | None,
    estimators: Sequence[EstimatorConfig],
    target_id: int = -1,
    progress: Progress = silent,
) -> Run:
    """Every estimator's local and fused estimates, beside them what mean and LCI make of the locals."""
    stage = None
    if sensing is not None:
        radios, _ = calibrated(sensing.channel, recording.anchors)
        stage = SensingStage(sensing.trigger, radios, seed=sensing.seed)
    parts = [_Part(c, *make_estimator(c, recording.anchors), frozenset(c.all_peers)) for c in estimators]
    others = compared(estimators[0].fusion) if len(estimators) > 1 else ()
    estimates: dict[str, list[Estimate]] = {}
    reports: list[TriggerReport] = []
    counters: Counter[str] = Counter(recording.dropped)
    spans: dict[int, Span] = {}

    def anew() -> None:
        each = (kept for part in parts for kept in (part.local, part.fuser))
        for kept in (*each, *others, *([stage] if stage else ())):
            kept.reset()

    for epoch in watched_epochs(recording, target_id, counters, spans, anew, progress):
        ranged = epoch
        if stage is not None:
            sensed = stage.step(epoch)
            reports.append(sensed.report)
            ranged = epoch._replace(measurements=sensed.ranges)
        locals_ = [
            local.step(_heard(config, ranged if config.input == 'range' else epoch)) for config, local, *_ in parts
        ]
        fused = _fused(parts, locals_)
        for (config, local, *_), estimate in zip(parts, fused, strict=True):
            if config.fusion.feedback:
                local.feed_back(estimate)
        for estimate in (*locals_, *fused, *(fuser.step(locals_) for fuser in others)):
            estimates.setdefault(estimate.source, []).append(estimate)
    if stage is None:
        targets = {e[0].target_id for e in estimates.values()}
        reports = [m for m in recording.messages if isinstance(m, TriggerReport) and m.target_id in targets]
    counters['gated'] += _gated(parts)
    return Run({name: tuple(e) for name, e in estimates.items()}, tuple(reports), spans, told(counters))


class _Part(NamedTuple):
    """One estimator."""

    config: EstimatorConfig
    local: LocalEstimator
    fuser: Fuser
    fuses: frozenset[int]  # the estimators whose local estimates it fuses


def _fused(parts: Sequence[_Part], locals_: Sequence[Estimate]) -> list[Estimate]:
    """What every estimator makes of its peers' local estimates; what several would compute alike is computed once."""
    done: dict[Hashable, Estimate] = {}
    fused = []
    for config, _, fuser, fuses in parts:
        alike = (config.fusion, config.area, fuses)
        if alike not in done:
            done[alike] = fuser.step([e for e in locals_ if e.contributors[0] in fuses])
        fused.append(done[alike]._replace(source=fuser.source))
    return fused


def _gated(parts: Sequence[_Part]) -> int:
    """Readings that were gated; estimators that hear the same nodes count once, by the worst of them."""
    worst: dict[tuple[int, ...], int] = {}
    for _, local, *_ in parts:
        hears = tuple(local.table.anchors.ids.tolist())
        worst[hears] = max(worst.get(hears, 0), local.counters['gated'])
    return sum(worst.values())


def _heard(config: EstimatorConfig, epoch: Epoch) -> Epoch:
    """The epoch as an estimator that hears only some nodes has it."""
    if not config.nodes:
        return epoch
    return epoch._replace(measurements=tuple(p for p in epoch.measurements if p.node_id in config.nodes))
