"""What real radio needs beyond Gaussian noise."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def student_t(noise: Function, z: Floats, read: Function, dof: float) -> Function:
    """Noise root of a Student-t channel, as a function of the state at which the residual is taken.

    R -> R (dof + e^2 / R) / (dof + 1) with e = z - read(x), read (..., K, N) -> expectation-maximisation for the
    scale of each reading: an iterated update (passes > 1) re-weighs with the latest posterior.
    """

    def weighed(x: Floats) -> Floats:
        root = noise(x)
        e = (z[..., None, :] - read(x)) / root
        return np.asarray(root * np.sqrt((dof + np.where(np.isnan(e), 0.0, e * e)) / (dof + 1.0)))

    return weighed


def gated(z: Floats, r: Regression, root_R: Floats, gate: float) -> Floats:
    """z (..., N) with NaN where a reading lies further than `gate` standard deviations from its prediction."""
    S = np.square(r.O).sum(axis=-1) + np.square(r.E).sum(axis=-1) + root_R**2
    with np.errstate(invalid='ignore'):
        return np.where((z - r.z_hat) ** 2 > gate**2 * S, np.nan, z)


def with_offsets(belief: Belief, std: Floats) -> Belief:
    """The belief with one more state a node, N(0, std^2), (N,): what its link reads too much."""
    n, N = belief.m.shape[-1], std.shape[-1]
    m = np.concatenate([belief.m, np.zeros((*belief.m.shape[:-1], N))], axis=-1)
    chol_P = np.zeros((*belief.m.shape[:-1], n + N, n + N))
    chol_P[..., :n, :n] = belief.chol_P
    chol_P[..., range(n, n + N), range(n, n + N)] = std
    return Belief(m, chol_P)
