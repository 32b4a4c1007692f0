"""System A once more, in covariance form and by the textbook: slow, dense, and none of the package's filters."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import range_function, relative_noise
from wsn_tracking.simulation.scenarios import scenario

properties = settings(max_examples=60, suppress_health_check=list(HealthCheck))
seeds = st.integers(0, 2**32 - 1)

LOOP = scenario('a_loop')
H = range_function(LOOP.anchors)
NOISE = relative_noise(LOOP.anchors, H)


# --- filters


def dense_points(m, P):
    spread = np.sqrt(m.size) * np.linalg.cholesky(P).T
    return np.concatenate([m + spread, m - spread])


def moments(m, P, h):
    """Mean, covariance and cross covariance with the state of h(x), x ~ N(m, P), by the cubature rule."""
    X = dense_points(m, P)
    Z = h(X)
    z_hat, d = Z.mean(axis=0), Z - Z.mean(axis=0)
    return z_hat, d.T @ d / len(X), (X - m).T @ d / len(X)


def dense_predict(m, P, F, Q):
    return F @ m, F @ P @ F.T + Q


def dense_ckf(m, P, z, h, R):
    """The covariance form of the cubature Kalman update (Arasaratnam, Haykin 2009)."""
    z_hat, P_zz, P_xz = moments(m, P, h)
    S = P_zz + R
    K = P_xz @ np.linalg.inv(S)
    return m + K @ (z - z_hat), P - K @ S @ K.T


def dense_iplf(m, P, z, h, noise, passes):
    """Iterated posterior linearisation by statistical linear regression: h(x) ~ A x + b + N(0, Omega)."""
    m_i, P_i = m, P
    for _ in range(passes):
        z_hat, P_zz, P_xz = moments(m_i, P_i, h)
        A = P_xz.T @ np.linalg.inv(P_i)
        Omega = P_zz - A @ P_i @ A.T
        R = np.diag(noise(m_i[None])[0] ** 2)
        m_i, P_i = kalman(m, P, z - (z_hat - A @ m_i), A, Omega + R)
    return m_i, P_i


def kalman(m, P, z, A, R):
    S = A @ P @ A.T + R
    K = P @ A.T @ np.linalg.inv(S)
    return m + K @ (z - A @ m), (np.eye(m.size) - K @ A) @ P


# --- fusion


def ci(m, P, w):
    """Covariance intersection of one set of J estimates."""
    Y = np.linalg.inv(P)
    fused = np.linalg.inv(np.einsum('j,jab->ab', w, Y))
    return fused @ np.einsum('j,jab,jb->a', w, Y, m), fused


def ci_trace(P, w):
    return float(np.trace(np.linalg.inv(np.einsum('j,jab->ab', w, np.linalg.inv(P)))))


def optimality_gap(P, w):
    """How far tr P(w) may lie above its minimum over the simplex, at most, as a share of it (Frank and Wolfe).

    tr P(w) is convex, so that it lies above each of its tangents.
    """
    Y = np.linalg.inv(P)
    fused = np.linalg.inv(np.einsum('j,jab->ab', w, Y))
    gradient = -np.einsum('ab,jbc,ca->j', fused, Y, fused)
    return float((w @ gradient - gradient.min()) / np.trace(fused))


def minimiser(f):
    """Where a convex f is least over [0, 1], by a grid that closes in."""
    low, high = 0.0, 1.0
    for _ in range(12):
        grid = np.linspace(low, high, 11)
        best = int(np.argmin([f(v) for v in grid]))
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, 10)]
    return grid[best]


def ici_pair(m_A, P_A, m_B, P_B, w):
    """Noack, Sijs, Reinhardt, Hanebeck 2017, eq. 10 to 12, as printed."""
    inv = np.linalg.inv
    G = inv(w * P_A + (1.0 - w) * P_B)
    P = inv(inv(P_A) + inv(P_B) - G)
    K, L = P @ (inv(P_A) - w * G), P @ (inv(P_B) - (1.0 - w) * G)
    return K @ m_A + L @ m_B, P, K, L


# --- what is drawn


def covariances(rng, *shape, n=4, condition=1e3):
    """Random covariances (*shape, n, n) with eigenvalues from 1/condition to 1."""
    U = np.linalg.qr(rng.standard_normal((*shape, n, n)))[0]
    values = condition ** -rng.random((*shape, n))
    return (U * values[..., None, :]) @ np.swapaxes(U, -1, -2)


def at_least(A, B, tolerance=1e-9):
    """A - B is positive semidefinite, up to rounding of their size."""
    difference = (A - B + np.swapaxes(A - B, -1, -2)) / 2.0
    size = np.maximum(np.trace(A, axis1=-2, axis2=-1), np.trace(B, axis1=-2, axis2=-1))
    return bool(np.all(np.linalg.eigvalsh(difference)[..., 0] >= -tolerance * size))


def beliefs(rng, *shape, position_std=0.15, velocity_std=0.06):
    """Means inside the loop's field (*shape, 4) and correlated covariances (*shape, 4, 4)."""
    x_min, y_min, x_max, y_max = LOOP.area
    scale = np.array([position_std, position_std, velocity_std, velocity_std])
    low, high = np.array([x_min, y_min, -0.1, -0.1]), np.array([x_max, y_max, 0.1, 0.1])
    P = covariances(rng, *shape, condition=20.0) * np.outer(scale, scale)
    return low + (high - low) * rng.random((*shape, 4)), P


def some_silent(rng, z, share=0.5):
    """The same measurements, of which a random share was not sent."""
    return np.where(rng.random(z.shape) < share, np.nan, z)


def small_anchors(**radio):
    return make_anchors([7, 3, 5], [[0.0, 0.0, 1.0], [2.0, 0.0, 0.5], [0.0, 3.0, 0.0]], **radio)
