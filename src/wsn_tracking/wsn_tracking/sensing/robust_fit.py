"""What can be said of readings some of which are wrong: straight lines, scatter, and which those are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.shrinkage import PopulationPrior
from wsn_tracking.sensing.survey import Survey

HUBER = 1.345  # robust scales: 95 % efficient on Gaussian residuals
FAR = 3.0  # standard deviations; of Gaussian readings 0.3 % are further away
OWN = 8.0  # readings that the scale of all nodes counts for beside a node's own, and what is assumed beside that
PASSES = 60
MANY = 100.0  # packets at one place; more tell no more of their scatter
TAIL = 3.0  # scatter beyond this many times the median's is another wrong reading
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
        scale = _scales(size, known, p, prior.scatter)
        trust = np.minimum(1.0, HUBER / np.maximum(size / scale, HUBER))
        if np.allclose(beta, before, rtol=1e-9, atol=1e-9):
            break
    far = np.maximum(size / (FAR * scale), 1.0)
    return far**-2.0, scale


def _scales(size: Floats, known: NDArray[np.bool_], p: int, assumed: float) -> Floats:
    """Scale of each node's residuals (N,), that of all nodes where it has few, the assumed one where all have few."""
    counts = known.sum(axis=0)
    own = np.array([np.median(size[known[:, k], k]) if counts[k] > p else 0.0 for k in range(counts.size)])
    share = np.maximum(counts - p, 0)
    all_nodes = GAUSSIAN * float(np.median(size[known]))
    common = (OWN * assumed**2 + share.sum() * all_nodes**2) / (OWN + share.sum())
    return np.asarray(np.maximum(np.sqrt((OWN * common + share * (GAUSSIAN * own) ** 2) / (OWN + share)), LEAST))


def packet_std(survey: Survey) -> tuple[Floats, Floats]:
    """Standard deviation of a node's packets at one place (N,), 0 where no place has two, and what tells it (N,).

    Pooled over the places. What scatters more than TAIL times as much as half of them do counts as that much;
    a node with few packets is helped by the others.
    """
    known = survey.known & np.isfinite(survey.scatter)
    w = np.where(known, np.minimum(survey.counts, MANY) - 1.0, 0.0)
    if not np.any(w > 0.0):
        return np.zeros(survey.ids.size), np.zeros(survey.ids.size)
    squares = np.where(known, survey.scatter, 0.0) ** 2
    limit = TAIL**2 * float(np.median(squares[w > 0.0]))
    squares = np.minimum(squares, limit) if limit > 0.0 else squares
    common = float(np.average(squares, weights=w))
    own = MANY * common + (w * squares).sum(axis=0)
    return np.sqrt(own / (MANY + w.sum(axis=0))), w.sum(axis=0)
