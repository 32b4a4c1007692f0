"""What no filter can beat: the posterior mean by many particles, for runs whose model is exactly known."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import matvec
from wsn_tracking.filters.resampling import systematic
from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.measurement import Function


def posterior_means(
    start: Belief,
    F: Floats,
    chol_Q: Floats,
    z: Floats,
    h: Function,
    noise: Function,
    particles: int,
    generator: np.random.Generator,
) -> Floats:
    """Means (runs, K, n) of a bootstrap particle filter (Gordon, Salmond, Smith 1993), resampled in every epoch.

    start (runs, n) is the belief before the first epoch's update; x_k = F x_k-1 + chol_Q w; z (runs, K, N), NaN
    where nothing was heard, of h with noise root `noise`: both map (..., particles, n) to (..., particles, N).
    """
    runs, epochs = z.shape[:2]
    n = start.m.shape[-1]

    def normals() -> Floats:
        return generator.standard_normal((runs, particles, n))

    x = start.m[:, None] + matvec(start.chol_P[:, None], normals())
    means = np.empty((runs, epochs, n))
    for k in range(epochs):
        if k:
            x = matvec(F, x) + matvec(chol_Q, normals())
        std = noise(x)
        terms = 0.5 * ((z[:, k, None] - h(x)) / std) ** 2 + np.log(std)
        log_w = -np.where(np.isnan(terms), 0.0, terms).sum(axis=-1)
        w = np.exp(log_w - log_w.max(axis=-1, keepdims=True))
        w /= w.sum(axis=-1, keepdims=True)
        means[:, k] = (w[..., None] * x).sum(axis=-2)
        x = np.take_along_axis(x, systematic(w, particles, generator)[..., None], axis=-2)
    return means
