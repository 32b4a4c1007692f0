"""What no filter can beat: the posterior mean by many particles, for runs whose model is exactly known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.linalg import matvec
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
        x = np.take_along_axis(x, _systematic(w, generator)[..., None], axis=-2)
    return means


def _systematic(w: Floats, generator: np.random.Generator) -> NDArray[np.int64]:
    """Indices (runs, particles) of systematic resampling with weights w (runs, particles)."""
    runs, particles = w.shape
    teeth = (np.arange(particles) + generator.random((runs, 1))) / particles
    sums = np.cumsum(w, axis=-1)
    sums[:, -1] = 1.0
    run = np.arange(runs)[:, None]  # one ascending axis for all: run r lies between r and r + 1
    chosen = np.searchsorted((sums + run).ravel(), (teeth + run).ravel()).reshape(runs, particles)
    return np.asarray(np.clip(chosen - run * particles, 0, particles - 1))
