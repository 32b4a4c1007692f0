"""The Matérn 3/2 covariance of a random field: rough like a room, with the one derivative that a filter needs."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import Floats

ROOT_3 = float(np.sqrt(3.0))


def matern(x: Floats, y: Floats, length: float) -> Floats:
    """Correlation (..., K) between places x (..., 2 or more: the first two count) and y (K, 2), all in [m].

    (1 + r) exp(-r) with r = sqrt(3) |x - y| / length (Rasmussen and Williams 2006, eq. 4.17).
    """
    dx = x[..., 0, None] - y[:, 0]
    dy = x[..., 1, None] - y[:, 1]
    r = np.sqrt(dx * dx + dy * dy) * (ROOT_3 / length)
    return np.asarray((1.0 + r) * np.exp(-r))
