"""Square-root cubature Kalman filter on whatever subset of nodes was heard (seed 000, algorithm 1).

Two forms give the same: `qr`, the document's, and `gram`, some times faster, which hands over to it near singularity.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wsn_tracking.filters import gram, qr
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.blocks import BLOCK, in_blocks
from wsn_tracking.filters.cubature import Regression, regress
from wsn_tracking.filters.linalg import every, matvec, transpose
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.measurement import Function

FORMS = ('gram', 'qr')


def predict(belief: Belief, F: Floats, chol_Q: Floats, form: str = 'gram') -> Belief:
    """Time update of a linear motion model: belief (..., n), F and chol_Q (..., n, n)."""
    if form == 'qr':
        return qr.predict(belief, F, chol_Q)
    return _trusted_or(*gram.predict(belief, F, chol_Q), lambda: qr.predict(belief, F, chol_Q))


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
    readings and noise roots (..., K, N); h treats all states of a batch alike. Each pass regresses h about the latest
    posterior and updates the prior anew (iterated posterior linearisation, Garcia-Fernandez et al. 2015), with the
    noise taken there. A row without measurement has no deviation, unit noise and no innovation, which leaves the state
    exactly as if the row were not there; with no row at all the prediction is the estimate. kappa: see `points`;
    offsets and seen: see `predicted_readings`.
    """

    def one_pass(prior: Belief, about: Belief, z: Floats, root_R: Floats) -> Belief:
        r = predicted_readings(prior, about, h, kappa, offsets, seen)
        return condition(prior, z, r, root_R, form)

    posterior = belief
    for _ in range(passes):
        root_R = noise(posterior.m[..., None, :])[..., 0, :]
        if belief.m.size + z.size > BLOCK:
            posterior = in_blocks(one_pass, belief, posterior, z, root_R)
        else:
            posterior = one_pass(belief, posterior, z, root_R)
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
        return Regression.of(z_hat, A @ prior.chol_P[..., :d, :d], r.E)
    O = A @ prior.chol_P[..., :d, :] + prior.chol_P[..., lead:, :]
    return Regression.of(z_hat + prior.m[..., lead:], O, r.E)


def condition(prior: Belief, z: Floats, r: Regression, root_R: Floats, form: str = 'gram') -> Belief:
    """The posterior of z (..., N), NaN where nothing was read, once h is as linear as `r` says about the prior."""
    missing = np.isnan(z)
    if form == 'qr':
        return qr.condition(prior, z, missing, r, root_R)
    fast = gram.condition(prior, z, missing, r, root_R)
    return _trusted_or(*fast, lambda: qr.condition(prior, z, missing, r, root_R))


def _trusted_or(fast: Belief, trusted: Mask, exact: Callable[[], Belief]) -> Belief:
    """The fast belief, and the exact one where any of its pivots (..., k) is not to be trusted."""
    if every(trusted):
        return fast
    m, chol_P = exact()
    whole = np.asarray(trusted.all(axis=-1))[..., None]
    return Belief(np.where(whole, fast.m, m), np.where(whole[..., None], fast.chol_P, chol_P))
