"""How good one output of a tracker was, and how several runs of it pool."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import metrics
from wsn_tracking.evaluation.consistency import effective_epochs, nees_interval, pooled_epochs
from wsn_tracking.evaluation.interpolation import GAP_S, Verdict, truth_at
from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.recording import Truth
from wsn_tracking.trackers.estimate import Estimate

SKIP_S = 5.0  # [s] a filter is given to settle


class Matched(NamedTuple):
    """Every estimate beside the truth, ascending in time."""

    stamps_ns: NDArray[np.int64]  # (K,)
    errors: Floats  # (K, 2) [m]; NaN where not scored
    covariances: Floats  # (K, 2, 2) [m^2] of the position; NaN where not known
    nees: Floats  # (K,); NaN where the covariance is not known or singular
    verdicts: NDArray[np.int64]  # (K,) Verdict


class Score(NamedTuple):
    """Accuracy and consistency of one output; NaN where nothing could be scored.

    The scored series themselves are kept (`matched`), so that pooling is exact for the median as well.
    """

    rmse_m: float
    median_m: float
    p95_m: float
    ei_m: float  # seed 000, eq. 25
    esi_m: tuple[float, float]  # x, y at the last epoch: seed 000, eq. 27
    nees: float  # mean of the 2-D position: 2 is consistent, more is overconfident
    nees_interval: tuple[float, float]  # 95 % acceptance interval of `nees` for the effective epochs
    nees_interval_independent: tuple[float, float]  # the same for nees_epochs, as if they were independent
    nees_epochs: int  # scored epochs with a usable covariance
    nees_effective_epochs: float  # independent epochs that these are worth
    epochs: int  # scored
    first_ns: int  # stamps of the first and the last scored epoch; 0 without any
    last_ns: int
    runs: int  # 1, or how many were pooled
    unscored: Mapping[str, int]  # estimates by reason: skipped, not_finite, outside_truth, truth_gap
    without_nees: Mapping[str, int]  # scored epochs by reason: covariance_unknown, covariance_singular
    matched: Matched  # the scored epochs alone


def match(estimates: Sequence[Estimate], truth: Truth, *, gap_s: float = GAP_S) -> Matched:
    """Lay estimates beside the truth at their own stamps.

    Raises TrackingError for estimates of another target, or whose first states are not x and y.
    """
    for estimate in estimates:
        if estimate.target_id != truth.target_id:
            raise TrackingError(
                f'output {estimate.source} holds target {estimate.target_id}, its truth is of target '
                f'{truth.target_id}: score each target against its own truth'
            )
        if tuple(estimate.state_names[:2]) != ('x', 'y'):
            raise TrackingError(
                f'output {estimate.source} has states {", ".join(estimate.state_names)}: x and y are expected first'
            )
    stamps = np.array([estimate.stamp_ns for estimate in estimates], dtype=np.int64)
    means = np.array([estimate.mean[:2] for estimate in estimates], dtype=np.float64).reshape(-1, 2)
    blocks = [np.asarray(estimate.covariance)[:2, :2] for estimate in estimates]
    covariances = np.array(blocks, dtype=np.float64).reshape(-1, 2, 2)
    order = np.argsort(stamps, kind='stable')
    stamps, means, covariances = stamps[order], means[order], covariances[order]
    real = truth_at(truth, stamps, gap_s)
    finite = np.all(np.isfinite(means), axis=-1)
    errors = np.where(finite[:, None], metrics.position_errors(means, real.positions), np.nan)
    verdicts = np.where(finite, real.verdicts, int(Verdict.NOT_FINITE))
    return Matched(stamps, errors, covariances, metrics.nees(errors, covariances), verdicts)


def score(
    estimates: Sequence[Estimate],
    truth: Truth,
    skip_s: float = SKIP_S,
    *,
    start_ns: int | None = None,
    gap_s: float = GAP_S,
) -> Score:
    """Score one output against the truth of its target, from skip_s after the start.

    start_ns: first epoch of the recording (default: of the estimates). gap_s: longest hole of the truth
    that is bridged. The nees_interval counts effective epochs (see consistency.py).
    """
    if not skip_s >= 0.0:
        raise TrackingError(f'skip is {skip_s} s, expected zero or more seconds')
    matched = match(estimates, truth, gap_s=gap_s)
    if matched.stamps_ns.size:
        start = int(matched.stamps_ns[0]) if start_ns is None else start_ns
        # A float of seconds: infinity (skip everything) must not become an integer.
        early = matched.stamps_ns - start < skip_s * 1e9
        matched = matched._replace(verdicts=np.where(early, int(Verdict.SKIPPED), matched.verdicts))
    unscored = {
        verdict.name.lower(): int(np.sum(matched.verdicts == verdict))
        for verdict in Verdict
        if verdict is not Verdict.SCORED
    }
    chosen = matched.verdicts == Verdict.SCORED
    scored = Matched(*(column[chosen] for column in matched))
    return _summarise(scored, float(effective_epochs(scored.nees)), 1, unscored)


def pool(scores: Sequence[Score]) -> Score:
    """One score over the epochs of all runs: what scoring their concatenation would give.

    ESI adds over the runs (seed 000, eq. 27). Runs are independent of each other, epochs within one are not.
    """
    if not scores:
        raise TrackingError('no score to pool: at least one is expected')
    columns = zip(*(s.matched for s in scores), strict=True)
    together = Matched(*(np.concatenate(column) for column in columns))
    effective = pooled_epochs(
        np.array([s.nees_epochs for s in scores], dtype=np.float64),
        np.array([s.nees_effective_epochs for s in scores], dtype=np.float64),
    )
    unscored = {reason: sum(s.unscored[reason] for s in scores) for reason in scores[0].unscored}
    return _summarise(together, effective, sum(s.runs for s in scores), unscored)


def _summarise(scored: Matched, effective: float, runs: int, unscored: Mapping[str, int]) -> Score:
    errors, epochs = scored.errors, scored.stamps_ns.size
    known = np.all(np.isfinite(scored.covariances), axis=(-2, -1))
    with_nees = int(np.sum(~np.isnan(scored.nees)))
    total = metrics.esi(errors)[-1] if epochs else np.full(2, np.nan)
    return Score(
        rmse_m=float(metrics.rmse(errors)),
        median_m=float(metrics.percentile(errors, 50.0)),
        p95_m=float(metrics.percentile(errors, 95.0)),
        ei_m=float(metrics.ei(errors)),
        esi_m=(float(total[0]), float(total[1])),
        nees=float(metrics.mean_known(scored.nees)),
        nees_interval=nees_interval(effective),
        nees_interval_independent=nees_interval(with_nees),
        nees_epochs=with_nees,
        nees_effective_epochs=effective,
        epochs=epochs,
        first_ns=int(scored.stamps_ns.min()) if epochs else 0,
        last_ns=int(scored.stamps_ns.max()) if epochs else 0,
        runs=runs,
        unscored=unscored,
        without_nees={
            'covariance_unknown': int(np.sum(~known)),
            'covariance_singular': int(np.sum(known)) - with_nees,
        },
        matched=scored,
    )
