"""Whether an observation arrives, as a two-state Markov chain: 1 it arrives, 0 it is lost (seed 002, section 1).

Bernoulli losses (seed 004) are the chain that forgets.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import Floats, Mask

CLIP = 1e-6  # a probability that is kept for the next epoch stays this far from 0 and 1: no state is ruled out for good
NEGLIGIBLE = 1e-8  # a weight below contributes exactly nothing


class Arrival(NamedTuple):
    """Transition matrix [[1 - q, q], [p, 1 - p]] of the states (lost, arrives), and where the chain starts."""

    p: float = 0.05  # fault rate: an arriving node loses its next observation
    q: float = 0.4  # repair rate: a losing node's next observation arrives
    start: float = 0.8  # probability that the first observation arrives


def chain(arrival: Arrival, uniform: Floats) -> Mask:
    """Which observations arrive, (..., K, N), of uniform draws (..., K, N): True where r = 1."""
    r: Mask = np.empty(uniform.shape, dtype=np.bool_)
    if r.shape[-2]:
        r[..., 0, :] = uniform[..., 0, :] < arrival.start
    for k in range(1, r.shape[-2]):
        r[..., k, :] = uniform[..., k, :] < np.where(r[..., k - 1, :], 1.0 - arrival.p, arrival.q)
    return r


def bernoulli(rate: float) -> Arrival:
    """Losses that know nothing of each other: each observation is lost with probability `rate` (seed 004)."""
    return Arrival(rate, 1.0 - rate, 1.0 - rate)


def bursts(rate: float, length: float) -> Arrival:
    """The stationary chain that loses a share `rate` in the long run, `length` epochs in a row on the average.

    A loss ends with q = 1 / length, and p = q rate / (1 - rate). Losses shorter than Bernoulli's, 1 / (1 - rate)
    epochs, would have to avoid each other: TrackingError.
    """
    if not 0.0 <= rate < 1.0:
        raise TrackingError(f'losses in bursts have a rate of {rate:g}: expected 0 or more and less than 1')
    if not length * (1.0 - rate) >= 1.0 - 1e-9:
        raise TrackingError(
            f'bursts of {length:g} epochs at a loss of {rate:g}: already independent losses last '
            f'{1.0 / (1.0 - rate):.3g} epochs in a row; take bursts at least as long, or none'
        )
    q = 1.0 / length
    return Arrival(min(q * rate / (1.0 - rate), 1.0), q, 1.0 - rate)


def predicted(arrival: Arrival, mu: Floats) -> Floats:
    """pi_1 = (1 - mu) q + mu (1 - p): the probability of arrival one epoch on (seed 002, the sum in eq. 20)."""
    return np.asarray((1.0 - mu) * arrival.q + mu * (1.0 - arrival.p))


def posterior(pi_1: Floats, l1: Floats, l0: Floats) -> Floats:
    """mu = pi_1 e^l1 / (pi_1 e^l1 + (1 - pi_1) e^l0) (seed 002, eq. 20) from log-likelihoods, all (...).

    In the log domain throughout: the likelihoods themselves underflow in most node-epochs.
    """
    with np.errstate(divide='ignore'):
        odds = np.log1p(-pi_1) - np.log(pi_1)
    return np.asarray(np.exp(-np.logaddexp(0.0, l0 - l1 + odds)))


def kept(mu: Floats) -> Floats:
    """What is kept of mu for the next epoch: clipped to [CLIP, 1 - CLIP]."""
    return np.asarray(np.clip(mu, CLIP, 1.0 - CLIP))
