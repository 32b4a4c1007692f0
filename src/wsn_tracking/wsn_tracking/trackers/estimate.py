"""What every tracker gives."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats

PLANAR_STATES = ('x', 'y', 'vx', 'vy')


class Kind(IntEnum):
    """Where an estimate comes from (TargetEstimate.KIND_*)."""

    LOCAL = 0
    FUSED = 1
    CONSENSUS = 2
    SMOOTHED = 3
    START = 4


class Estimate(NamedTuple):
    """Belief in a target's state after one epoch."""

    stamp_ns: int
    target_id: int
    request_seq: int
    source: str  # name of the output, e.g. local_1
    mean: Floats  # (n,) [m, m/s, ...], frame map
    covariance: Floats  # (n, n); NaN where it is not known
    contributors: tuple[int, ...] = ()  # estimators (or nodes) whose estimates went in, ascending
    measurements: tuple[int, ...] = ()  # nodes whose measurements were used, ascending
    q: float = float('nan')  # process noise parameter drawn for this epoch
    kind: int = Kind.LOCAL
    state_names: tuple[str, ...] = PLANAR_STATES


def check_usable(estimate: Estimate) -> Estimate:
    """Itself, or TrackingError where no fusion may use it: another state, NaN, or a covariance that is none."""
    who = f'estimate {estimate.source!r} of epoch {estimate.request_seq}'
    if estimate.state_names != PLANAR_STATES:
        raise TrackingError(f'{who} has the states {estimate.state_names}: expected {PLANAR_STATES}')
    P = estimate.covariance
    if not (np.all(np.isfinite(estimate.mean)) and np.all(np.isfinite(P))):
        raise TrackingError(f'{who} holds NaN or infinity: expected finite numbers')
    d = np.sqrt(np.maximum(np.diag(P), 0.0))
    if np.any(d == 0.0) or np.any(np.abs(P - P.T) > 1e-9 * np.outer(d, d)):
        raise TrackingError(f'{who} has a covariance that is not symmetric with a positive diagonal')
    if np.linalg.eigvalsh(P / np.outer(d, d))[0] < 1e-12:
        raise TrackingError(f'{who} has a singular or indefinite covariance: expected a positive definite one')
    return estimate
