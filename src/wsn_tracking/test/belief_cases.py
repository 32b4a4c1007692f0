"""Beliefs about the robot of a_loop, what its nodes would tell, and how far two beliefs may be apart."""

import numpy as np
from hypothesis import strategies as st
from oracles import NOISE, H, beliefs, some_silent

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import matvec
from wsn_tracking.filters.srckf import FORMS
from wsn_tracking.models.motion import constant_velocity

forms = st.sampled_from(FORMS)
F = constant_velocity(1.0)


def drawn(seed, *shape, silent=0.5, noise=0.12, **options):
    """Beliefs, and what the nodes would tell of a state that is drawn from each."""
    rng = np.random.default_rng(seed)
    m, P = beliefs(rng, *shape, **options)
    belief = Belief(m, np.linalg.cholesky(P))
    truth = m + matvec(belief.chol_P, rng.standard_normal(m.shape))
    z = np.maximum(H(truth) * (1.0 + noise * rng.standard_normal((*shape, 12))), 0.01)
    return belief, some_silent(rng, z, silent)


def heard(z):
    """What the oracles, which know no silence, may look at: the functions of the nodes that were heard."""
    rows = np.flatnonzero(~np.isnan(z))
    return z[rows], lambda x: H(x)[..., rows], lambda x: NOISE(x)[..., rows]


def close(belief, m, P, rtol):
    """Relative to the size of the covariance: that is the unit in which an estimate may be off."""
    unit = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    np.testing.assert_allclose((belief.m - m) / unit, 0.0, atol=rtol)
    np.testing.assert_allclose((belief.P - P) / (unit[..., :, None] * unit[..., None, :]), 0.0, atol=rtol)
