"""Where the target really was at any instant."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.recording import Truth

GAP_S = 2.0  # [s] a person turns a corner in this time: a straight line over more is no truth


class Verdict(IntEnum):
    """Why an estimate is scored or not."""

    SCORED = 0
    SKIPPED = 1
    NOT_FINITE = 2
    OUTSIDE_TRUTH = 3
    TRUTH_GAP = 4


class TruthAt(NamedTuple):
    """Truth at K stamps."""

    positions: Floats  # (K, 3) [m]; NaN where it is not known
    verdicts: NDArray[np.int64]  # (K,) Verdict: SCORED, OUTSIDE_TRUTH or TRUTH_GAP


def truth_at(truth: Truth, stamps_ns: NDArray[np.int64], gap_s: float = GAP_S) -> TruthAt:
    """Linear interpolation at (K,) stamps; time differences are taken in integer nanoseconds.

    At a recorded stamp the recorded position itself comes back. Unknown outside the recording, and
    between two recorded positions more than gap_s apart. A row of the truth that is NaN is not recorded.
    """
    recorded = np.all(np.isfinite(truth.positions), axis=-1)
    t, p = truth.stamps_ns[recorded], truth.positions[recorded]
    if t.size == 0:
        nowhere = np.full((stamps_ns.size, 3), np.nan)
        return TruthAt(nowhere, np.full(stamps_ns.shape, int(Verdict.OUTSIDE_TRUTH), dtype=np.int64))
    at = np.searchsorted(t, stamps_ns, side='right') - 1
    before = np.clip(at, 0, t.size - 1)
    after = np.minimum(before + 1, t.size - 1)
    since, span = stamps_ns - t[before], t[after] - t[before]
    share = since / np.maximum(span, 1)
    between = p[before] + share[:, None] * (p[after] - p[before])
    outside = (stamps_ns < t[0]) | (stamps_ns > t[-1])
    in_gap = (since != 0) & (span > round(gap_s * 1e9))
    verdicts = np.where(
        outside, int(Verdict.OUTSIDE_TRUTH), np.where(in_gap, int(Verdict.TRUTH_GAP), int(Verdict.SCORED))
    )
    known = verdicts == Verdict.SCORED
    return TruthAt(np.where(known[:, None], between, np.nan), verdicts.astype(np.int64))
