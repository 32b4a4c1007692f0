"""What is told about one bag (or several): the scores, and what became of the measurements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation.score import SKIP_S, Score, pool
from wsn_tracking.sensing.values import Reason, TriggerReport

IN_RADIUS = (Reason.UNCHANGED, Reason.NOISY, Reason.NOT_DRAWN)  # heard well, and held back by the trigger
RECEIVED = (*IN_RADIUS, Reason.OUT_OF_RADIUS)


class Traffic(NamedTuple):
    """How many measurements the trigger let through."""

    sent: int = 0
    in_radius: int = 0  # sent, or held back though near enough
    received: int = 0  # in radius, or too weak
    on_board: int = 0  # silent by the mote's own trigger: whether in radius is not known

    @property
    def share(self) -> float:
        """Sent of in radius; NaN where no trigger reported (or the motes decided)."""
        return self.sent / self.in_radius if self.in_radius and not self.on_board else float('nan')


class Summary(NamedTuple):
    """One target of one bag, or several pooled."""

    title: str  # the bag's name
    target_id: int | None  # None: pooled over different targets
    epochs: int  # closed, scored or not
    outputs: Mapping[str, Score]  # by the name of the output, in the order of the table
    input: Mapping[str, int]  # messages that were not used, by reason
    traffic: Traffic = Traffic()
    skip_s: float = SKIP_S


def traffic(reports: Iterable[TriggerReport]) -> Traffic:
    """Count what the sensing nodes reported."""
    sent, silent = 0, Counter[int]()
    for report in reports:
        sent += len(report.sent_ids)
        silent.update(report.reasons)
    return Traffic(
        sent=sent,
        in_radius=sent + sum(silent[reason] for reason in IN_RADIUS),
        received=sent + sum(silent[reason] for reason in RECEIVED),
        on_board=silent[Reason.ON_BOARD],
    )


def pool_summaries(summaries: Sequence[Summary]) -> Summary:
    """All epochs of all bags as one.

    An output that some bags lack is pooled over the others; its `runs` says how many.
    """
    if not summaries:
        raise TrackingError('no bag to pool: at least one is expected')
    names = dict.fromkeys(name for summary in summaries for name in summary.outputs)
    targets = {summary.target_id for summary in summaries}
    dropped = Counter[str]()
    for summary in summaries:
        dropped.update(summary.input)
    return Summary(
        title=f'pooled over {len(summaries)} bags' if len(summaries) > 1 else summaries[0].title,
        target_id=targets.pop() if len(targets) == 1 else None,
        epochs=sum(summary.epochs for summary in summaries),
        outputs={name: pool([s.outputs[name] for s in summaries if name in s.outputs]) for name in names},
        input=dict(dropped),
        traffic=Traffic(*(sum(column) for column in zip(*(s.traffic for s in summaries), strict=True))),
        skip_s=max(summary.skip_s for summary in summaries),
    )
