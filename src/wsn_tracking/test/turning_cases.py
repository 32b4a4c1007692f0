"""System E once more by the textbook: dense matrices, sigma points one by one, and none of the package's filters."""

from __future__ import annotations

import numpy as np

# The roots are lower triangular in these orders of the states: first what f, or h, is nonlinear in.
TURNING = [2, 3, 4, 0, 1]
SEEN = [0, 1, 2, 3, 4]


def derivative(x):
    """dx/dt of a velocity that turns at w."""
    return np.array([x[2], x[3], -x[4] * x[3], x[4] * x[2], 0.0])


def integrated(x, T, steps=4000):
    """The state after T, by Runge and Kutta's fourth order."""
    dt = T / steps
    for _ in range(steps):
        a = derivative(x)
        b = derivative(x + 0.5 * dt * a)
        c = derivative(x + 0.5 * dt * b)
        d = derivative(x + dt * c)
        x = x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return x


def turned(x, T):
    """One state after T, by the printed equations, w not near zero."""
    px, py, vx, vy, w = x
    s, c = np.sin(w * T), np.cos(w * T)
    return np.array(
        [
            px + s / w * vx - (1 - c) / w * vy,
            py + (1 - c) / w * vx + s / w * vy,
            c * vx - s * vy,
            s * vx + c * vy,
            w,
        ]
    )


def noise(sv, sw, T):
    """Q = blkdiag(sv^2 (G x I2), sw^2 T)."""
    G = np.array([[T**4 / 4, T**3 / 2], [T**3 / 2, T**2]])
    Q = np.zeros((5, 5))
    Q[:4, :4] = sv**2 * np.kron(G, np.eye(2))
    Q[4, 4] = sw**2 * T
    return Q


def sigma_points(m, P, kappa, order):
    """Points and weights of the unscented rule; kappa = 0: of the cubature rule."""
    n = m.size
    root = np.zeros((n, n))
    root[order] = np.linalg.cholesky(P[np.ix_(order, order)])
    points, weights = [m], [kappa / (n + kappa)]
    for column in root.T:
        for sign in (1.0, -1.0):
            points.append(m + sign * np.sqrt(n + kappa) * column)
            weights.append(0.5 / (n + kappa))
    return np.array(points), np.array(weights)


def dense_predict(m, P, f, Q, kappa=0.0):
    X, w = sigma_points(m, P, kappa, TURNING)
    Y = np.array([f(x) for x in X])
    mean = w @ Y
    d = Y - mean
    return mean, (w[:, None] * d).T @ d + Q


def dense_update(m, P, z, h, R, kappa=0.0):
    """With the rows that were heard; z has NaN for the others."""
    heard = ~np.isnan(z)
    X, w = sigma_points(m, P, kappa, SEEN)
    Z = np.array([h(x[None])[0] for x in X])[:, heard]
    z_hat = w @ Z
    d = Z - z_hat
    S = (w[:, None] * d).T @ d + R[np.ix_(heard, heard)]
    K = (w[:, None] * (X - m)).T @ d @ np.linalg.inv(S)
    return m + K @ (z[heard] - z_hat), P - K @ S @ K.T


def differences(f, x, step):
    """The derivative of f at x by central differences, a column a state."""
    columns = [(f(x + e) - f(x - e)) / (2 * e.max()) for e in np.diag(step)]
    return np.array(columns).T
