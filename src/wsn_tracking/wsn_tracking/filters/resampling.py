"""Which particles go on: indices (..., n) drawn by weights (..., P) that sum to one (Douc, Cappe, Moulines 2005).

Each keeps the expected number of copies of particle j at n w_j; they differ in how far a draw scatters about that. A
particle of weight zero is never drawn. The number n may differ from P; leading axes are runs of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats

Indices = NDArray[np.int64]
Resampler = Callable[[Floats, int, np.random.Generator], Indices]
BELOW_ONE = 1.0 - 2.0**-53  # the last place in a cumulative sum: (n - 1 + u) / n may be rounded to one
BELOW_ROW = 1.0 - 2.0**-30  # one that is still below one with a row's number added


def systematic(w: Floats, n: int, generator: np.random.Generator) -> Indices:
    """One draw for all: the teeth of a comb. Copies of j are the floor or the ceiling of n w_j, or one off that."""
    teeth = np.arange(n) + generator.random((*w.shape[:-1], 1))
    teeth /= n
    return _located(w, teeth)


def stratified(w: Floats, n: int, generator: np.random.Generator) -> Indices:
    """A draw of its own in each of n equal parts."""
    return _located(w, (np.arange(n) + generator.random((*w.shape[:-1], n))) / n)


def multinomial(w: Floats, n: int, generator: np.random.Generator) -> Indices:
    """Independent draws, made in ascending order: sums of exponential spacings."""
    sums = np.cumsum(generator.standard_exponential((*w.shape[:-1], n + 1)), axis=-1)
    return _located(w, sums[..., :-1] / sums[..., -1:])


def residual(w: Floats, n: int, generator: np.random.Generator) -> Indices:
    """floor(n w_j) copies for certain; what is left to n is drawn independently by what is left of the weights."""
    copies = np.floor(n * w)
    left = n * w - copies
    missing = n - copies.sum(axis=-1, keepdims=True)
    total = left.sum(axis=-1, keepdims=True)
    # Where nothing is missing nothing is drawn, and any distribution will do.
    drawn = multinomial(np.where(total > 0.0, left / np.where(total > 0.0, total, 1.0), w), n, generator)
    kept = _thinned(drawn, missing, generator)
    row = np.arange(kept.size // n).reshape((*kept.shape[:-1], 1)) * w.shape[-1]
    copies += np.bincount((row + drawn)[kept], minlength=copies.size).reshape(copies.shape)
    return np.asarray(_rank(np.cumsum(copies, axis=-1), np.broadcast_to(np.arange(n), drawn.shape)))


RESAMPLERS: Mapping[str, Resampler] = {
    'systematic': systematic,
    'stratified': stratified,
    'multinomial': multinomial,
    'residual': residual,
}


def _thinned(drawn: Indices, keep: Floats, generator: np.random.Generator) -> NDArray[np.bool_]:
    """A random choice of `keep` (..., 1) of the draws (..., n), which are in ascending order and so no sample."""
    order = np.argsort(generator.random(drawn.shape), axis=-1)
    return np.asarray(order < keep)


def _located(w: Floats, places: Floats) -> Indices:
    """The particle in whose share of the cumulative weights each of the ascending places (..., n) in [0, 1) lies."""
    sums = np.cumsum(w, axis=-1)
    sums /= sums[..., -1:]  # the last is exactly one: no place is beyond it
    return _rank(sums, np.minimum(places, BELOW_ONE if w.ndim == 1 else BELOW_ROW))


def _rank(sums: Floats, places: Floats) -> Indices:
    """How many of the ascending sums (..., P) are at or below each place (..., n)."""
    if sums.ndim == 1:
        return sums.searchsorted(places, side='right')
    rows = int(np.prod(sums.shape[:-1]))
    # One ascending axis for all: row r lies within [r, r + 1) times the row's last sum, which all rows share.
    lift = np.arange(rows).reshape((*sums.shape[:-1], 1))
    found = (sums + sums[..., -1:] * lift).ravel().searchsorted((places + sums[..., -1:] * lift).ravel(), side='right')
    return np.asarray(found.reshape(places.shape) - lift * sums.shape[-1], dtype=np.int64)
