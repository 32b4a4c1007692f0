"""Covariance intersection of three 4 x 4 estimates with the least trace: ours against SciPy's SLSQP."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from wsn_tracking.benchmarks.rows import Row, Sizes, at_least, at_most, cpu_seconds
from wsn_tracking.fusion import covariance_intersection as ci
from wsn_tracking.fusion.simplex import minimise_trace
from wsn_tracking.models.anchors import Floats

GROUP, WORK = 'fusion', 'CI of three 4 x 4, least trace'
SETS = 20

Fuse = Callable[[], list[ci.Fused]]


def estimates(seed: int = 1, sets: int = SETS) -> tuple[Floats, Floats]:
    """Means (sets, 3, 4) and covariances (sets, 3, 4, 4), each good at something else."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((sets, 3, 4, 4)) * 10.0 ** rng.uniform(-1.0, 0.5, (sets, 3, 1, 4))
    return rng.standard_normal((sets, 3, 4)), A @ np.swapaxes(A, -1, -2) + 1e-2 * np.eye(4)


def ours(m: Floats, P: Floats) -> Fuse:
    """Ours, set after set as a node does it."""
    return lambda: [ci.optimal(*one) for one in zip(m, P, strict=True)]


def slsqp(m: Floats, P: Floats, *, gradient: bool = False) -> Fuse:
    """SciPy's general optimiser as it is usually called, or with the exact gradient, as precise as it can be."""
    from scipy.optimize import minimize

    def fuse(m: Floats, P: Floats) -> ci.Fused:
        Y = np.linalg.inv(P)

        def trace(w: Floats) -> float:
            return float(np.trace(np.linalg.inv(np.tensordot(w, Y, 1))))

        def both(w: Floats) -> tuple[float, Floats]:
            fused = np.linalg.inv(np.tensordot(w, Y, 1))
            return float(np.trace(fused)), -np.trace(fused @ Y @ fused, axis1=-2, axis2=-1)

        found = minimize(
            both if gradient else trace,
            ci.trace_weights(P),
            jac=gradient or None,
            method='SLSQP',
            bounds=[(0.0, 1.0)] * len(P),
            constraints={'type': 'eq', 'fun': lambda w: w.sum() - 1.0, 'jac': np.ones_like},
            options={'ftol': 1e-12, 'maxiter': 200},
        )
        w = np.maximum(found.x, 0.0)
        return ci.intersect(m, Y, w / w.sum())

    return lambda: [fuse(*one) for one in zip(m, P, strict=True)]


def gap(P: Floats) -> float:
    """Largest share of the trace by which our weights may miss the optimum: f(w) - f* <= max_j (w - e_j)' grad f."""
    Y = ci.information(P)
    w = minimise_trace(Y, ci.trace_weights(P))
    fused = np.linalg.inv((w[..., None, None] * Y).sum(axis=-3))
    gradient = -np.trace(fused[..., None, :, :] @ Y @ fused[..., None, :, :], axis1=-2, axis2=-1)
    most = (w * gradient).sum(axis=-1) - gradient.min(axis=-1)
    return float((most / np.trace(fused, axis1=-2, axis2=-1)).max())


def rows(sizes: Sizes) -> Iterable[Row]:
    """Time per fusion, and how exact it is."""
    m, P = estimates()
    contenders = {'ours': ours(m, P), 'slsqp': slsqp(m, P), 'exact': slsqp(m, P, gradient=True)}
    took = {name: 1e6 * seconds / SETS for name, seconds in cpu_seconds(contenders, sizes).items()}
    yield Row(GROUP, WORK, 'us', took['ours'], 'SciPy SLSQP', took['slsqp'], at_least(5.0, ratio=True))
    yield Row(GROUP, WORK, 'us', took['ours'], 'SLSQP, exact gradient', took['exact'])
    yield Row(GROUP, 'its trace above the optimum, at most', 'share', gap(estimates(2, 500)[1]), goal=at_most(1e-9))
