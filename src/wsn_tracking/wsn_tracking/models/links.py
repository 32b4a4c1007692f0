"""Radio links that lose what is sent, to the sink or between nodes, and networks that part."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.arrival import Arrival, bernoulli, bursts, chain

GOLDEN = 0x9E3779B97F4A7C15  # the increment of SplitMix64, and its two multipliers
FIRST, SECOND = 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


def hashed_uniform(*words: ArrayLike) -> Floats:
    """A uniform number in [0, 1) for each combination of integers, broadcast together: a draw keyed by all of them.

    SplitMix64's mixer (Steele, Lea and Flood 2014) over one word after another: one draw out of many costs no more than
    its share of all of them.
    """
    with np.errstate(over='ignore'):
        h = np.zeros((), dtype=np.uint64)
        for word in words:
            h = _mixed(h + np.uint64(GOLDEN) + np.asarray(word).astype(np.uint64))
    return np.asarray((h >> np.uint64(11)) * 2.0**-53)


def _mixed(h: NDArray[np.uint64]) -> NDArray[np.uint64]:
    h = (h ^ (h >> np.uint64(30))) * np.uint64(FIRST)
    h = (h ^ (h >> np.uint64(27))) * np.uint64(SECOND)
    return h ^ (h >> np.uint64(31))


class Loss(NamedTuple):
    """How what a network sends to its sink gets lost (seed 004: gamma)."""

    rate: float = 0.0  # share that is lost in the long run
    burst: float = 0.0  # mean number of epochs in a row that a loss lasts; 0: losses know nothing of each other
    whole_round: bool = False  # all nodes of an epoch together, not each link on its own

    def arrival(self) -> Arrival:
        """The chain of one link, or of the whole round."""
        return bursts(self.rate, self.burst) if self.burst else bernoulli(self.rate)


def gamma(loss: Loss, uniform: Floats) -> Mask:
    """Which readings arrive, (..., K, N) of uniform draws (..., K, N): True where gamma = 1.

    Of a whole round the first node's draw decides.
    """
    one = uniform[..., :1] if loss.whole_round else uniform
    return np.broadcast_to(chain(loss.arrival(), one), uniform.shape)


class Links(NamedTuple):
    """What happens between nodes; ids and epochs are integers."""

    loss: float = 0.0  # probability that a receiver misses one share
    seed: int = 0
    cut_at: float = 0.0  # [m] links across this x are cut ...
    cut_from: int = 0  # ... from this epoch on ...
    cut_until: int = 0  # ... to the one before this


def lost(links: Links, seed: ArrayLike, epoch: int, round_: ArrayLike, sender: ArrayLike, receiver: ArrayLike) -> Mask:
    """Whether a share is lost, keyed by (seed, epoch, round, from, to): the same for all who ask, in whatever order."""
    return np.asarray(hashed_uniform(seed, epoch, round_, sender, receiver) < links.loss)


def is_cut(links: Links, epoch: int, x_sender: ArrayLike, x_receiver: ArrayLike) -> Mask:
    """Whether the link between nodes at these x [m] is down in an epoch."""
    sides = (np.asarray(x_sender) < links.cut_at) != (np.asarray(x_receiver) < links.cut_at)
    return np.asarray(sides & (links.cut_from <= epoch < links.cut_until))
