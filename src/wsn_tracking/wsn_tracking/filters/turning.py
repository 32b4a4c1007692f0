"""Time update of a motion model that is nonlinear in its last states alone, by the cubature or unscented rule."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import regress
from wsn_tracking.filters.linalg import tria
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def predict(belief: Belief, f: Function, chol_Q: Floats, added: int, kappa: float = 0.0) -> Belief:
    """Moments of f(x) + w, w ~ N(0, Q): belief (..., n), f of states (..., K, n), chol_Q (..., n, n).

    The first `added` states p are where a way g starts that depends on the others u alone: f(p, u) = [p, 0] + g(u).
    With the root [[A, 0], [B, C]] of [u, p], the rule's points along C all make the same way: g is regressed over u
    with kappa + added, and every moment is that of the rule over all n states. So an unscented kappa may be as low as
    -added without a covariance that is none, and the points are fewer.
    """
    m, chol_P = belief
    n = m.shape[-1]
    d = n - added
    S = tria(chol_P[..., [*range(added, n), *range(added)], :])

    def g(u: Floats) -> Floats:
        return f(np.concatenate([np.zeros((*u.shape[:-1], added)), u], axis=-1))

    r = regress(g, Belief(m[..., added:], S[..., :d, :d]), kappa + added)
    mean, odd, rest = r.z_hat.copy(), r.O.copy(), np.zeros((*m.shape, added))
    mean[..., :added] += m[..., :added]
    odd[..., :added, :] += S[..., d:, :d]
    rest[..., :added, :] = S[..., d:, d:]
    chol_Q = np.broadcast_to(chol_Q, chol_P.shape)
    return Belief(mean, tria(np.concatenate([odd, rest, r.E, chol_Q], axis=-1)))
