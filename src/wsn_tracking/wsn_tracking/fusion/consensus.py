"""Consensus schemes: what a node tells its neighbours, and what it makes of the agreement (seed 002, section 2.2).

Everything here is one row of packed information a node, (..., d); schemes differ in the row that they average and in
how the average becomes a posterior. n is the number of live nodes that can reach each other: the document's N is wrong
as soon as one dies or the network falls apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats

Start = Callable[[Floats, Floats, Floats], Floats]
Finish = Callable[[Floats, Floats, Floats, Floats], Floats]


class Scheme(NamedTuple):
    """One way to agree. `prior` is P^-1 x and P^-1, `own` the node's contribution i and I."""

    name: str
    start: Start  # (prior, own, n before) -> what is averaged, or flooded
    finish: Finish  # (prior, result of the rounds, n before, n after) -> posterior information
    flooded: bool = False  # rows are forwarded with their node's id instead of being averaged
    accelerated: bool = False


def _cm_finish(prior: Floats, average: Floats, before: Floats, after: Floats) -> Floats:
    """Y = P^-1 + n I (seed 002, section 2.3, step 5)."""
    return prior + after[..., None] * average


def _icf_finish(prior: Floats, average: Floats, before: Floats, after: Floats) -> Floats:
    """Y = n V, in a network that neither grows nor shrinks.

    Of what grows, the newcomers' share is left out; of what shrinks, the node's own prior stands in for those that
    went. All priors together never count more than once.
    """
    n = np.minimum(before, after)
    return n[..., None] * average + (1.0 - n / before)[..., None] * prior


def _shared_prior(prior: Floats, own: Floats, before: Floats) -> Floats:
    """V = P^-1 / n + I (Kamal, Farrell and Roy-Chowdhury 2013): all priors together count once."""
    return prior / before[..., None] + own


SCHEMES: Mapping[str, Scheme] = {
    scheme.name: scheme
    for scheme in (
        Scheme('cm', lambda prior, own, n: own, _cm_finish),
        Scheme('icf', _shared_prior, _icf_finish),
        Scheme('chebyshev', _shared_prior, _icf_finish, accelerated=True),
        Scheme('flood', lambda prior, own, n: own, lambda prior, total, before, after: prior + total, flooded=True),
        # Battistelli et al. 2015 with gamma = 1: no n at all, so that nothing is ever counted twice
        Scheme('hcmci', lambda prior, own, n: prior + own, lambda prior, average, before, after: average),
    )
}


def average_of_neighbours(own: Floats, rows: Floats, weights: Floats) -> Floats:
    """One node's round: own row (d,), what it heard (J, d) and its weights (J,), in the order of the nodes' ids."""
    return np.asarray((1.0 - weights.sum()) * own + weights @ rows)


def accelerated(mixed: Floats, before: Floats, omega: Floats | float) -> Floats:
    """Chebyshev's step from the weighted average `mixed` and the row of the round before."""
    return np.asarray(omega * (mixed - before) + before)


def polynomial(W: Floats, omegas: Floats) -> Floats:
    """The matrix of all Chebyshev rounds, for weights (..., N, N) and factors (..., L)."""
    before: Floats = np.broadcast_to(np.eye(W.shape[-1]), W.shape)
    now = before
    for t in range(omegas.shape[-1]):
        before, now = now, accelerated(W @ now, before, omegas[..., t, None, None])
    return np.asarray(now)
