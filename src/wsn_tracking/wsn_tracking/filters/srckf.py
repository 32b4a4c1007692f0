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


def update(
    belief: Belief,
    z: Floats,
    h: Function,
    noise: Function,
    passes: int = 1,
    kappa: float = 0.0,
    offsets: int = 0,
) -> Belief:
    """Measurement update; one pass is the SRCKF (seed 000, eq. 10 to 19), more are the IPLF.

    belief (..., n); z (..., N), NaN where a node sent nothing; h and noise map states (..., K, n) to
    readings and noise roots (..., K, N). Each pass regresses h about the latest posterior and updates the
    prior anew (iterated posterior linearisation, Garcia-Fernandez et al. 2015), with the noise taken there.
    A row without measurement has no deviation, unit noise and no innovation, which leaves the state exactly
    as if the row were not there; with no row at all the prediction is the estimate. kappa: see `points`;
    offsets: see `predicted_readings`.
    """
    missing = np.isnan(z)
    posterior = belief
    for _ in range(passes):
        r = predicted_readings(belief, posterior, h, kappa, offsets)
        root_R = noise(posterior.m[..., None, :])[..., 0, :]
        posterior = _condition(belief, z, missing, r, root_R)
    return posterior


def predicted_readings(prior: Belief, about: Belief, h: Function, kappa: float, offsets: int = 0) -> Regression:
    """h regressed about a belief, as a prediction from the prior: z_hat there, O against the prior's root.

    The last `offsets` states are added to the readings as they are, one a node: h regresses over the others.
    """
    lead = prior.m.shape[-1] - offsets
    r = regress(h, Belief(about.m[..., :lead], about.chol_P[..., :lead, :lead]), kappa)
    if offsets == 0 and about is prior:
        return r
    A = transpose(np.linalg.solve(transpose(about.chol_P[..., :lead, :lead]), transpose(r.O)))
    z_hat = r.z_hat + matvec(A, prior.m[..., :lead] - about.m[..., :lead])
    O = A @ prior.chol_P[..., :lead, :]
    if offsets:
        z_hat = z_hat + prior.m[..., lead:]
        O = O + prior.chol_P[..., lead:, :]
    return Regression(z_hat, O, r.E)


def _condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> Belief:
    """Triangularise [[O, S_R, E], [chol_P, 0, 0]] into [[S_zz, 0], [K, chol_P+]]; m+ = m + K S_zz^-1 (z - z_hat).

    One QR gives S_zz (eq. 15), the gain (eq. 17) and the posterior root (eq. 19) at once.
    """
    m, chol_P = prior
    n, N, e = m.shape[-1], z.shape[-1], r.E.shape[-1]
    batch = np.broadcast_shapes(m.shape[:-1], z.shape[:-1])
    heard = ~missing
    pre = np.zeros((*batch, N + n, n + N + e))
    pre[..., :N, :n] = r.O * heard[..., None]
    pre[..., range(N), range(n, n + N)] = np.where(missing, 1.0, root_R)
    pre[..., :N, n + N :] = r.E * heard[..., None]
    pre[..., N:, :n] = chol_P
    post = tria(pre)
    innovation = np.where(missing, 0.0, z - r.z_hat)
    whitened = solve(post[..., :N, :N], innovation)
    return Belief(m + matvec(post[..., N:, :N], whitened), post[..., N:, N:])
