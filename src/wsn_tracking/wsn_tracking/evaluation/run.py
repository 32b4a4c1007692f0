"""What all systems have in common when they run on a recording without any middleware: epochs in, a scored run out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from wsn_tracking.evaluation.score import SKIP_S, score
from wsn_tracking.evaluation.summary import Summary, traffic
from wsn_tracking.sensing.epochs import NO_LOSS, EpochAssembler
from wsn_tracking.sensing.recording import Recording
from wsn_tracking.sensing.values import Epoch, EpochEnd, Request, TriggerReport
from wsn_tracking.trackers.estimate import Estimate

Progress = Callable[[Iterator[Epoch], int], Iterator[Epoch]]


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


def watched_epochs(
    recording: Recording,
    target_id: int,
    counters: Counter[str],
    spans: dict[int, Span],
    anew: Callable[[], None],
    progress: Progress,
) -> Iterator[Epoch]:
    """The same epochs, counted in `spans`, their progress shown."""
    total = sum(isinstance(message, EpochEnd) for message in recording.messages)
    for epoch in progress(epochs_of(recording, target_id, counters, anew), total):
        span = spans.get(epoch.target_id, Span(0, epoch.stamp_ns))
        spans[epoch.target_id] = span._replace(epochs=span.epochs + 1)
        yield epoch


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
