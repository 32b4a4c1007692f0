"""Where a belief says that the target is with 95 %: ellipses of its position."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.models.anchors import Floats
from wsn_tracking.trackers.estimate import Estimate

CHI2_95 = 5.991464547107979  # chi-square, 2 degrees of freedom, at 0.95: -2 ln 0.05


def ellipse(mean: Floats, covariance: Floats, points: int = 73) -> Floats:
    """Border of the 95 % region, (..., 2) and (..., 2, 2) -> (..., points, 2) [m]; the last point is the first.

    A circle of radius sqrt(CHI2_95) through the Cholesky factor. Raises LinAlgError where P is not definite.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    circle = np.sqrt(CHI2_95) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.asarray(mean[..., None, :] + circle @ np.swapaxes(np.linalg.cholesky(covariance), -1, -2))


def known(estimates: Sequence[Estimate]) -> tuple[Floats, Floats]:
    """Positions (M, 2) [m] and covariances (M, 2, 2) [m^2] of those with a finite and definite belief."""
    means = np.array([e.mean[:2] for e in estimates], dtype=np.float64).reshape(-1, 2)
    blocks = np.array([np.asarray(e.covariance)[:2, :2] for e in estimates], dtype=np.float64).reshape(-1, 2, 2)
    definite = np.isfinite(nees(0.0 * means, blocks))
    return means[definite], blocks[definite]
