"""A Gaussian belief in square-root form."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats


class Belief(NamedTuple):
    """N(m, P) with P = chol_P chol_P'; m (..., n), chol_P (..., n, n) lower triangular."""

    m: Floats
    chol_P: Floats

    @property
    def P(self) -> Floats:
        """Covariance (..., n, n)."""
        return self.chol_P @ np.swapaxes(self.chol_P, -1, -2)
