"""A recording through system A without any middleware: what the graph computes, estimator by estimator."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from typing import NamedTuple

from wsn_tracking.evaluation.score import SKIP_S, score
from wsn_tracking.evaluation.summary import Summary, traffic
from wsn_tracking.sensing.channel import calibrated
from wsn_tracking.sensing.epochs import NO_LOSS, EpochAssembler
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.stage import SensingStage, TriggerConfig
from wsn_tracking.sensing.values import Epoch, EpochEnd, Request, TriggerReport
from wsn_tracking.trackers.estimate import Estimate
from wsn_tracking.trackers.estimator import EstimatorConfig, make_estimator
from wsn_tracking.trackers.fusing import Fuser, compared
from wsn_tracking.trackers.random_q import LocalEstimator

Progress = Callable[[Iterator[Epoch], int], Iterator[Epoch]]


class Sensing(NamedTuple):
    """Parameters of the sensing stage."""

    trigger: TriggerConfig
    seed: int
    channel: str = ''  # file of `calibrate`; empty: the anchors tell


class Span(NamedTuple):
    """The epochs of one target."""

    epochs: int
    start_ns: int  # stamp of the first


class Run(NamedTuple):
    """What came out."""

    estimates: Mapping[str, tuple[Estimate, ...]]  # by output
    reports: tuple[TriggerReport, ...]
    spans: Mapping[int, Span]  # by target
    dropped: Mapping[str, int]  # input that was not used, by reason

    @property
    def epochs(self) -> int:
        """Of all targets."""
        return sum(span.epochs for span in self.spans.values())

    @property
    def start_ns(self) -> int:
        """Stamp of the first epoch; 0 without any."""
        return min((span.start_ns for span in self.spans.values()), default=0)


def merged(runs: Sequence[Run]) -> Run:
    """Several systems on one recording; what all of them could not use counts once."""
    dropped: Counter[str] = Counter()
    for run in runs:
        dropped |= Counter(run.dropped)
    return Run(
        {name: estimates for run in runs for name, estimates in run.estimates.items()},
        tuple(report for run in runs for report in run.reports),
        {target: span for run in runs for target, span in sorted(run.spans.items())},
        dropped,
    )


def told(counters: Mapping[str, int]) -> dict[str, int]:
    """The counters of input that was not used."""
    return {reason: n for reason, n in counters.items() if n and reason not in NO_LOSS}


def silent(epochs: Iterator[Epoch], total: int) -> Iterator[Epoch]:
    """No progress is shown."""
    return epochs


def epochs_of(
    recording: Recording, target_id: int, counters: Counter[str], anew: Callable[[], None] = lambda: None
) -> Iterator[Epoch]:
    """The epochs of a recording that has EpochEnds, in order; what they leave out is added to `counters`.

    `anew` is called where time falls back: a new run begins. Raises TrackingError for an epoch that lacks something.
    """
    assembler = EpochAssembler(recording.anchors.ids.tolist(), target_id=target_id, loss_timeout=1.0, lossless=True)
    runs = 0

    def closed(now: float) -> Iterator[Epoch]:
        nonlocal runs
        while epochs := assembler.closed(now):
            if assembler.runs != runs:
                runs = assembler.runs
                anew()
            yield from epochs

    for message in recording.messages:
        if isinstance(message, Request):
            assembler.request(message, 0.0)
        elif isinstance(message, (EpochEnd, TriggerReport)):
            assembler.listing(message, 0.0)
        else:
            assembler.measurement(message, 0.0)
        yield from closed(0.0)
    yield from closed(1.0)
    counters.update({**assembler.run_counters, 'no_request': assembler.held})


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
    total = sum(isinstance(message, EpochEnd) for message in recording.messages)
    spans: dict[int, Span] = {}

    def anew() -> None:
        each = (kept for part in parts for kept in (part.local, part.fuser))
        for kept in (*each, *others, *([stage] if stage else ())):
            kept.reset()

    for epoch in progress(epochs_of(recording, target_id, counters, anew), total):
        count_epoch(spans, epoch)
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


def count_epoch(spans: dict[int, Span], epoch: Epoch) -> None:
    """One more epoch of its target."""
    span = spans.get(epoch.target_id, Span(0, epoch.stamp_ns))
    spans[epoch.target_id] = span._replace(epochs=span.epochs + 1)


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


def summarise(title: str, recording: Recording, run: Run, skip_s: float = SKIP_S) -> Summary:
    """Score every output against the truth of its target; without a truth there is nothing to score."""
    scores = {}
    for name, estimates in run.estimates.items():
        target = estimates[0].target_id
        if target in recording.truth:
            scores[name] = score(estimates, recording.truth[target], skip_s, start_ns=run.spans[target].start_ns)
    return Summary(
        title,
        next(iter(run.spans)) if len(run.spans) == 1 else None,
        run.epochs,
        scores,
        run.dropped,
        traffic(run.reports),
        skip_s,
    )
