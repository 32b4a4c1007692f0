"""Square-root cubature Kalman filter on whatever subset of nodes was heard (seed 000, algorithm 1).

Two forms give the same: `qr`, the document's, and `gram`, some times faster, which hands over to it near singularity.
"""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters import gram
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.blocks import in_blocks
from wsn_tracking.filters.cubature import Regression, regress
from wsn_tracking.filters.linalg import matvec, solve, transpose, tria
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.measurement import Function

FORMS = ('gram', 'qr')


def predict(belief: Belief, F: Floats, chol_Q: Floats, form: str = 'gram') -> Belief:
    """Time update of a linear motion model (seed 000, eq. 7 to 9).

    belief (..., n), F and chol_Q (..., n, n). The cubature rule is exact for linear f: the deviations of
    its propagated points are F chol_P, their mean is F m.
    """
    propagated, m = F @ belief.chol_P, matvec(F, belief.m)
    root, trusted = gram.predicted_root(propagated, chol_Q) if form == 'gram' else _untrusted
    if not trusted.all():
        shape = np.broadcast_shapes(propagated.shape, chol_Q.shape)
        stacked = [np.broadcast_to(part, shape) for part in (propagated, chol_Q)]
        root = np.where(trusted[..., None, None], root, tria(np.concatenate(stacked, axis=-1)))
    return Belief(m if m.ndim == root.ndim - 1 else np.broadcast_to(m, root.shape[:-1]), root)


def update(
    belief: Belief,
    z: Floats,
    h: Function,
    noise: Function,
    passes: int = 1,
    kappa: float = 0.0,
    offsets: int = 0,
    seen: int | None = None,
    form: str = 'gram',
) -> Belief:
    """Measurement update; one pass is the SRCKF (seed 000, eq. 10 to 19), more are the IPLF.

    belief (..., n); z (..., N), NaN where a node sent nothing; h and noise map states (..., K, n) to
    readings and noise roots (..., K, N). Each pass regresses h about the latest posterior and updates the
    prior anew (iterated posterior linearisation, Garcia-Fernandez et al. 2015), with the noise taken there.
    A row without measurement has no deviation, unit noise and no innovation, which leaves the state exactly
    as if the row were not there; with no row at all the prediction is the estimate. kappa: see `points`;
    offsets and seen: see `predicted_readings`.
    """

    def one_pass(m: Floats, chol_P: Floats, about_m: Floats, about_S: Floats, z: Floats, root_R: Floats) -> Belief:
        prior = Belief(m, chol_P)
        about = prior if about_m is m else Belief(about_m, about_S)
        r = predicted_readings(prior, about, h, kappa, offsets, seen)
        return _condition(prior, z, np.isnan(z), r, root_R, form)

    posterior = belief
    for _ in range(passes):
        root_R = noise(posterior.m[..., None, :])[..., 0, :]
        posterior = in_blocks(one_pass, [*belief, *posterior, z, root_R], (1, 2, 1, 2, 1, 1))
    return posterior


def predicted_readings(
    prior: Belief, about: Belief, h: Function, kappa: float, offsets: int = 0, seen: int | None = None
) -> Regression:
    """h regressed about a belief, as a prediction from the prior: z_hat there, O against the prior's root.

    The last `offsets` states are added to the readings as they are, one a node: h regresses over the others. Of these
    it looks at the first `seen` (all), which makes the rule a smaller one (see `regress`).
    """
    lead = prior.m.shape[-1] - offsets
    d = lead if seen is None else seen
    r = regress(h, Belief(about.m[..., :d], about.chol_P[..., :d, :d]), kappa + lead - d)
    if offsets == 0 and about is prior:
        return r
    A = transpose(np.linalg.solve(transpose(about.chol_P[..., :d, :d]), transpose(r.O)))
    z_hat = r.z_hat + matvec(A, prior.m[..., :d] - about.m[..., :d])
    if offsets == 0:
        return Regression(z_hat, A @ prior.chol_P[..., :d, :d], r.E)
    O = A @ prior.chol_P[..., :d, :] + prior.chol_P[..., lead:, :]
    return Regression(z_hat + prior.m[..., lead:], O, r.E)


_untrusted = gram.Root(np.array(np.nan), np.array(False))


def _condition(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats, form: str) -> Belief:
    """The posterior of the prior given z, in the form asked for where that can be trusted."""
    if form != 'gram':
        return _condition_qr(prior, z, missing, r, root_R)
    posterior, trusted = gram.condition(prior, z, missing, r, root_R)
    if trusted.all():
        return posterior
    exact = _condition_qr(prior, z, missing, r, root_R)
    m = np.where(trusted[..., None], posterior.m, exact.m)
    return Belief(m, np.where(trusted[..., None, None], posterior.chol_P, exact.chol_P))


def _condition_qr(prior: Belief, z: Floats, missing: Mask, r: Regression, root_R: Floats) -> Belief:
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
