"""Which particles go on: indices (..., n) drawn by weights (..., P) that sum to one (Douc, Cappe, Moulines 2005).

Each keeps the expected number of copies of particle j at n w_j; they differ in how far a draw scatters about that. A
particle of weight zero is never drawn. The number n may differ from P; leading axes are runs of their own.
"""

from __future__ import annotations

import math
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
    u = np.minimum(generator.random((*w.shape[:-1], 1)), BELOW_ROW)
    copies = np.ceil(n * _shares(w) - u).astype(np.int64)  # how many of the teeth (i + u) / n lie below each sum
    copies[..., 1:] -= copies[..., :-1].copy()
    return _repeated(copies, n)


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
    return _repeated(copies.astype(np.int64), n)


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


def _shares(w: Floats) -> Floats:
    """The cumulative weights (..., P), of which the last is exactly one: no place in [0, 1) is beyond it."""
    sums = w.cumsum(axis=-1)
    sums /= sums[..., -1:]
    return sums


def _repeated(copies: Indices, n: int) -> Indices:
    """Each particle as often as copies (..., P) say, in ascending order; in every row they sum to n."""
    if copies.ndim == 1:
        return np.arange(copies.size).repeat(copies)
    all_rows = np.arange(copies.size).repeat(copies.ravel())
    return np.asarray(all_rows.reshape((*copies.shape[:-1], n)) % copies.shape[-1])


def _located(w: Floats, places: Floats) -> Indices:
    """The particle in whose share of the cumulative weights each of the ascending places (..., n) in [0, 1) lies."""
    sums = _shares(w)
    if w.ndim == 1:
        return sums.searchsorted(np.minimum(places, BELOW_ONE), side='right')
    places = np.minimum(places, BELOW_ROW)
    # One ascending axis for all: row r lies within [r, r + 1).
    lift = np.arange(math.prod(sums.shape[:-1])).reshape((*sums.shape[:-1], 1))
    found = (sums + lift).ravel().searchsorted((places + lift).ravel(), side='right')
    return np.asarray(found.reshape(places.shape) - lift * sums.shape[-1], dtype=np.int64)
