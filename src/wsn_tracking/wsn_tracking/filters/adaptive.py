"""How many particles are enough: KLD sampling (Fox 2003)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats


class Kld(NamedTuple):
    """So many particles that their distribution over cells differs from the true one by at most `error`."""

    error: float = 0.05  # Kullback-Leibler distance
    cell: float = 0.5  # [m] side of a cell
    quantile: float = 2.33  # of the normal distribution: 2.33 keeps the bound in 99 % of the draws
    least: int = 100
    most: int = 10000


def enough(kld: Kld, places: Floats) -> int:
    """Number of particles for a distribution that these particles (2, P) [m] stand for."""
    cells = np.floor(places / kld.cell).astype(np.int64)
    cells -= cells.min(axis=-1, keepdims=True)
    k = np.unique(cells[0] * (cells[1].max() + 1) + cells[1]).size
    return min(max(bound(k, kld.error, kld.quantile), kld.least), kld.most)


def bound(k: int, error: float, quantile: float) -> int:
    """n = chi^2_{k-1, quantile} / (2 error) by the Wilson-Hilferty transformation, for k occupied cells."""
    if k < 2:
        return 1
    a = 2.0 / (9.0 * (k - 1))
    return math.ceil((k - 1) / (2.0 * error) * (1.0 - a + math.sqrt(a) * quantile) ** 3)
