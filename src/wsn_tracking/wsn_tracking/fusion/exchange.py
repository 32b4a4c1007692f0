"""All rounds of an epoch at once, for every node of every run: the matrix form of what nodes do by messages.

Rows x (..., N, d) start as `Scheme.start` makes them. Where nothing is lost and nobody falls back, all rounds are one
product with a matrix that is kept from epoch to epoch; otherwise they are done one by one, as the nodes do them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wsn_tracking.errors import TrackingError
from wsn_tracking.fusion.consensus import Scheme, accelerated, polynomial
from wsn_tracking.fusion.weights import chebyshev_factors, chebyshev_guard, contraction, metropolis
from wsn_tracking.models.anchors import Floats, Mask
from wsn_tracking.models.graph import degrees, reached

Heard = Callable[[int], Mask]  # round -> which shares arrive: (..., N, N), receiver first


class Agreement(NamedTuple):
    """What the rounds gave."""

    value: Floats  # (..., N, d)
    plain: Floats  # (..., N, d) the same with a last round that is not accelerated
    known: Mask  # (..., N, N) of whom each node has heard, in however many hops
    items: Mask  # (..., N, N) whose rows have come through to each node, where rows are flooded


class Exchange:
    """The rounds of one network, epoch after epoch.

    graph (..., N, N): who would hear whom if all lived. Raises TrackingError where an accelerated scheme has fewer
    rounds than pay.
    """

    def __init__(self, scheme: Scheme, rounds: int, graph: Mask) -> None:
        self.scheme, self.rounds, self.graph = scheme, rounds, graph
        self._at: tuple[Mask, Mask] | None = None  # heard and active of the matrices that are kept
        self._all: Floats
        self._known: Mask
        self.omegas = np.ones((*graph.shape[:-2], rounds))
        if scheme.accelerated:
            rho = contraction(metropolis(graph, degrees(graph)))
            for run in np.ndindex(rho.shape):
                check_rounds(float(rho[run]), rounds)
                self.omegas[run] = chebyshev_factors(float(rho[run]), rounds)

    def lossless(self, x: Floats, heard: Mask, active: Mask) -> Agreement:
        """Every share of a neighbour that is heard arrives; active (..., N, N): the neighbours that still count."""
        if self.scheme.accelerated and not (np.array_equal(heard, active) and np.array_equal(active, self.graph)):
            return self.by_rounds(x, lambda _: heard, active)
        if self._at is None or not (np.array_equal(heard, self._at[0]) and np.array_equal(active, self._at[1])):
            self._keep(heard, active)
        value = self._all @ x
        plain = self._plain @ x if self.scheme.accelerated else value
        return Agreement(value, plain, self._known, self._known)

    def _keep(self, heard: Mask, active: Mask) -> None:
        self._at = heard, active
        self._known = reached(heard, self.rounds)
        if self.scheme.flooded:
            self._all = self._known.astype(np.float64)
            return
        W = metropolis(heard, degrees(active))
        if self.scheme.accelerated:
            self._all = polynomial(W, self.omegas)
            self._plain = W @ polynomial(W, self.omegas[..., :-1])
        else:
            self._all = np.linalg.matrix_power(W, self.rounds)  # seed 002, eq. 13, so many times

    def by_rounds(self, x: Floats, heard: Heard, active: Mask) -> Agreement:
        """Round by round, with whatever shares arrive in each."""
        degree = degrees(active)
        known = reached(active, 0)
        items: Mask = known
        new: Mask = known
        value: Floats = x
        before: Floats = x
        mixed: Floats = x
        fallen_back = np.any(active != self.graph, axis=-1)
        for t in range(self.rounds):
            A = heard(t)
            if self.scheme.flooded:
                new = _any(A, new) & ~items
                items = items | new
            else:
                after: Floats = metropolis(A, degree) @ value
                mixed = after
                if self.scheme.accelerated:
                    told = np.any(A & fallen_back[..., None, :], axis=-1)
                    fallen_back = fallen_back | told | np.any(active & ~A, axis=-1)
                    omega = np.where(fallen_back, 1.0, self.omegas[..., t, None])[..., None]
                    after = accelerated(mixed, before, omega)
                before, value = value, after
            known = known | _any(A, known)
        if self.scheme.flooded:
            value = mixed = items.astype(np.float64) @ x
        return Agreement(value, mixed, known, items)


def check_rounds(rho: float, rounds: int) -> None:
    """Raise TrackingError where acceleration does not pay on a graph whose weights contract by rho."""
    guard = chebyshev_guard(rho)
    if rounds < guard:
        raise TrackingError(
            f'chebyshev has {rounds} rounds on a graph that contracts by {rho:.4f} a round: expected at least {guard}; '
            'set `rounds`, or `scheme` to icf'
        )


def _any(heard: Mask, what: Mask) -> Mask:
    """What at least one of those who are heard has."""
    return np.asarray(heard.astype(np.float32) @ what.astype(np.float32) > 0.5)
