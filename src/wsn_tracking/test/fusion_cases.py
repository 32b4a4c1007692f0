"""Sets of estimates to fuse."""

import numpy as np
from hypothesis import strategies as st
from oracles import covariances

from wsn_tracking.fusion import covariance_intersection as fusion
from wsn_tracking.fusion.simplex import minimise_trace

counts = st.integers(1, 5)
sizes = st.integers(1, 5)


def estimates(seed, *shape, n=4, condition=1e3):
    """Means (*shape, n) and covariances (*shape, n, n)."""
    rng = np.random.default_rng(seed)
    return rng.standard_normal((*shape, n)), covariances(rng, *shape, n=n, condition=condition)


def best_weights(P):
    """Those of the least trace."""
    return minimise_trace(fusion.information(P), fusion.trace_weights(P))
