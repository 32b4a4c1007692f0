"""Per-link offsets that drift: what a link reads too much or too little for some seconds (shadowing, posture)."""

from __future__ import annotations

import math

import numpy as np

from wsn_tracking.models.anchors import Floats


def drift(F: Floats, chol_Q: Floats, dt: float, std: Floats, time: float) -> tuple[Floats, Floats]:
    """Transition and noise root of a motion model (n, n) with an offset a node behind it, (n + N, n + N).

    Each offset is a stationary Gauss-Markov process of standard deviation std (N,) and correlation time `time`
    [s]: b <- a b + w, a = exp(-dt / time), w ~ N(0, std^2 (1 - a^2)).
    """
    n, N = F.shape[-1], std.shape[-1]
    a = math.exp(-dt / time)
    whole_F, whole_Q = a * np.eye(n + N), np.zeros((n + N, n + N))
    whole_F[:n, :n] = F
    whole_Q[:n, :n] = chol_Q
    whole_Q[range(n, n + N), range(n, n + N)] = std * math.sqrt(1.0 - a * a)
    return whole_F, whole_Q
