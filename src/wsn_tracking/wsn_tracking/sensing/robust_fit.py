"""Straight lines through readings of which some are wrong, and which those are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.shrinkage import PopulationPrior

HUBER = 1.345  # robust scales: 95 % efficient on Gaussian residuals
FAR = 3.0  # standard deviations; of Gaussian readings 0.3 % are further away
OWN = 8.0  # readings that the scale of all nodes counts for beside a node's own
PASSES = 60
LEAST = 1e-6  # scale, far below any radio's resolution
GAUSSIAN = 1.4826  # standard deviation of Gaussian values over the median of their sizes


def outlier_weights(
    H: Floats, y: Floats, known: NDArray[np.bool_], weights: Floats, prior: PopulationPrior
) -> tuple[Floats, Floats]:
    """How much each reading is to be trusted, (K, N) in (0, 1], and the scale of each node's residuals, (N,).

    y (K, N) ~ H (K, N, p) beta_k, `known` where there is a reading, `weights` (K, N) of equally good ones. Huber's
    line per node (iteratively reweighted least squares, loosely held by the population's prior, so that two
    readings do as well), scales by the median of the absolute residuals. Whatever lies beyond FAR scales counts
    as a reading with a standard deviation so much larger that it lies at FAR.
    """
    N, p = y.shape[1], H.shape[-1]
    variance = np.square(prior.std) + np.square(prior.spread)
    z = np.where(known, y, 0.0)
    trust = np.ones(y.shape)
    scale = np.full(N, np.inf)
    beta = np.tile(prior.mean, (N, 1))
    for _ in range(PASSES):
        w = np.where(known, weights * trust, 0.0)
        precision = np.where(np.isfinite(scale), scale, 0.0)[:, None, None] ** 2 * np.diag(1.0 / variance)
        precision = precision + 1e-9 * np.diag(1.0 / variance)  # the first pass is plain least squares
        A = np.einsum('kn,kni,knj->nij', w, H, H) + precision
        b = np.einsum('kn,kni,kn->ni', w, H, z) + precision @ prior.mean
        before, beta = beta, np.linalg.solve(A, b[..., None])[..., 0]
        size = np.abs(z - np.einsum('kni,ni->kn', H, beta)) * np.sqrt(weights)
        scale = _scales(size, known, p)
        trust = np.minimum(1.0, HUBER / np.maximum(size / scale, HUBER))
        if np.allclose(beta, before, rtol=1e-9, atol=1e-9):
            break
    far = np.maximum(size / (FAR * scale), 1.0)
    return far**-2.0, scale


def _scales(size: Floats, known: NDArray[np.bool_], p: int) -> Floats:
    """Scale of each node's residuals (N,), that of all nodes where it has few."""
    counts = known.sum(axis=0)
    common = GAUSSIAN * float(np.median(size[known]))
    own = np.array([np.median(size[known[:, k], k]) if counts[k] > p else 0.0 for k in range(counts.size)])
    share = np.maximum(counts - p, 0)
    return np.maximum(np.sqrt((OWN * common**2 + share * (GAUSSIAN * own) ** 2) / (OWN + share)), LEAST)
