"""Square-root cubature Kalman filter on whatever subset of nodes was heard (seed 000, algorithm 1)."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.cubature import Regression, regress
from wsn_tracking.filters.linalg import matvec, solve, transpose, tria
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.measurement import Function


def predict(belief: Belief, F: Floats, chol_Q: Floats) -> Belief:
    """Time update of a linear motion model (seed 000, eq. 7 to 9).

    belief (..., n), F and chol_Q (..., n, n). The cubature rule is exact for linear f: the deviations of
    its propagated points are F chol_P, their mean is F m.
    """
    m, chol_P = belief
    propagated = F @ chol_P
    shape = np.broadcast_shapes(propagated.shape, chol_Q.shape)
    stacked = np.concatenate([np.broadcast_to(propagated, shape), np.broadcast_to(chol_Q, shape)], axis=-1)
    return Belief(matvec(F, m), tria(stacked))


def update(belief: Belief, z: Floats, h: Function, noise: Function, passes: int = 1) -> Belief:
    """Measurement update; one pass is the SRCKF (seed 000, eq. 10 to 19), more are the IPLF.

    belief (..., n); z (..., N), NaN where a node sent nothing; h and noise map states (..., K, n) to
    readings and noise roots (..., K, N). Each pass regresses h about the latest posterior and updates the
    prior anew (iterated posterior linearisation, Garcia-Fernandez et al. 2015), with the noise taken there.
    A row without measurement has no deviation, unit noise and no innovation, which leaves the state exactly
    as if the row were not there; with no row at all the prediction is the estimate.
    """
    missing = np.isnan(z)
    posterior = belief
    for i in range(passes):
        r = regress(h, posterior)
        root_R = noise(posterior.m[..., None, :])[..., 0, :]
        if i == 0:
            slope, z_hat = r.O, r.z_hat
        else:
            whitened = np.linalg.solve(transpose(posterior.chol_P), transpose(r.O))
            A = transpose(whitened)
            slope = A @ belief.chol_P
            z_hat = r.z_hat + matvec(A, belief.m - posterior.m)
        posterior = _condition(belief, z, missing, Regression(z_hat, slope, r.E), root_R)
    return posterior


def _condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> Belief:
    """Triangularise [[O, S_R, E], [chol_P, 0, 0]] into [[S_zz, 0], [K, chol_P+]]; m+ = m + K S_zz^-1 (z - z_hat).

    One QR gives S_zz (eq. 15), the gain (eq. 17) and the posterior root (eq. 19) at once.
    """
    m, chol_P = prior
    n, N = m.shape[-1], z.shape[-1]
    batch = np.broadcast_shapes(m.shape[:-1], z.shape[:-1])
    heard = ~missing
    pre = np.zeros((*batch, N + n, n + N + n))
    pre[..., :N, :n] = r.O * heard[..., None]
    pre[..., range(N), range(n, n + N)] = np.where(missing, 1.0, root_R)
    pre[..., :N, n + N :] = r.E * heard[..., None]
    pre[..., N:, :n] = chol_P
    post = tria(pre)
    innovation = np.where(missing, 0.0, z - r.z_hat)
    e = solve(post[..., :N, :N], innovation)
    return Belief(m + matvec(post[..., N:, :N], e), post[..., N:, N:])
