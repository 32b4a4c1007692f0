"""Predict and update by orthogonal transformations, as in algorithm 1 of seed 000: the reference."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression
from wsn_tracking.filters.linalg import matvec, solve, tria
from wsn_tracking.models.anchors import Floats, Mask


def predict(belief: Belief, F: Floats, chol_Q: Floats) -> Belief:
    """Time update of a linear motion model (seed 000, eq. 7 to 9).

    The cubature rule is exact for linear f: the deviations of its propagated points are F chol_P, their mean is F m.
    """
    m, chol_P = belief
    propagated = F @ chol_P
    shape = np.broadcast_shapes(propagated.shape, chol_Q.shape)
    stacked = np.concatenate([np.broadcast_to(propagated, shape), np.broadcast_to(chol_Q, shape)], axis=-1)
    return Belief(np.broadcast_to(matvec(F, m), shape[:-1]), tria(stacked))


def condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> Belief:
    """Triangularise [[O, S_R, E], [chol_P, 0, 0]] into [[S_zz, 0], [K, chol_P+]]; m+ = m + K S_zz^-1 (z - z_hat).

    One QR gives S_zz (eq. 15), the gain (eq. 17) and the posterior root (eq. 19) at once.
    """
    m, chol_P = prior
    n, N, d, e = m.shape[-1], z.shape[-1], r.O.shape[-1], r.E.shape[-1]
    batch = np.broadcast_shapes(m.shape[:-1], z.shape[:-1])
    heard = ~missing
    pre = np.zeros((*batch, N + n, n + N + e))
    pre[..., :N, :d] = r.O * heard[..., None]
    pre[..., range(N), range(n, n + N)] = np.where(missing, 1.0, root_R)
    pre[..., :N, n + N :] = r.E * heard[..., None]
    pre[..., N:, :n] = chol_P
    post = tria(pre)
    innovation = np.where(missing, 0.0, z - r.z_hat)
    whitened = solve(post[..., :N, :N], innovation)
    return Belief(m + matvec(post[..., N:, :N], whitened), post[..., N:, N:])
