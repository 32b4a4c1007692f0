"""System B once more by the textbook: loops over nodes, dense matrices, and not a line of the package's filters."""

from __future__ import annotations

import numpy as np

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Epoch, RangeBearing
from wsn_tracking.trackers.consensus_node import ConsensusNode

SECOND = 1_000_000_000
R = np.diag([0.1**2, 0.5**2])
R_MAX = 600.0


def turned(angle):
    """In (-pi, pi], by complex numbers."""
    return np.angle(np.exp(1j * angle))


def dense_moments(m, P, position):
    """Cubature moments of range and bearing, the bearing as a deviation from that at m."""
    n = m.size
    spread = np.sqrt(n) * np.linalg.cholesky(P).T
    X = np.concatenate([m + spread, m - spread])
    d = X[:, :2] - position[:2]
    at = np.arctan2(*(m[:2] - position[:2])[::-1])
    Z = np.column_stack([np.hypot(*d.T), at + turned(np.arctan2(d[:, 1], d[:, 0]) - at)])
    z_hat = Z.mean(axis=0)
    return z_hat, (Z - z_hat).T @ (Z - z_hat) / len(X), (X - m).T @ (Z - z_hat) / len(X)


def dense_contribution(m, P, position, z, pi_1, loss='uniform', omega_weight=1.0):
    """i, I and mu of one node that reads both range and bearing (seed 002, eq. 16 to 21)."""
    z_hat, P_zz, P_xz = dense_moments(m, P, position)
    H = (np.linalg.inv(P) @ P_xz).T
    v = z - z_hat
    v[1] = turned(v[1])
    l1 = density(v, P_zz + R)
    l0 = {'uniform': -np.log(2 * np.pi * R_MAX), 'zero': density(z, R), 'absent': -np.inf}[loss]
    mu = 1.0 / (1.0 + np.exp(np.clip(l0 - l1 + np.log((1 - pi_1) / pi_1), -700, 700)))
    noise = R + omega_weight * (P_zz - H @ P @ H.T)
    return mu * H.T @ np.linalg.solve(noise, v + H @ m), mu * H.T @ np.linalg.solve(noise, H), mu


def density(v, S):
    return -0.5 * (v @ np.linalg.solve(S, v) + np.log(np.linalg.det(2 * np.pi * S)))


def dense_centralised(positions, z, m, P, omega_weight):
    """Means (K, 4) and covariances of one filter that holds all readings z (K, N, 2)."""
    F = np.eye(4) + np.diag([1.0, 1.0], 2)
    Q = np.kron([[1 / 3, 1 / 2], [1 / 2, 1]], np.eye(2))
    mu, out = np.full(len(positions), 0.8), []
    for k in range(len(z)):
        if k:
            m, P = F @ m, F @ P @ F.T + Q
        Y = np.linalg.inv(P)
        y = Y @ m
        for j, position in enumerate(positions):
            pi_1 = (1 - mu[j]) * 0.4 + mu[j] * 0.95 if k else 0.8
            i, I, mu_j = dense_contribution(m, P, position, z[k, j], pi_1, omega_weight=omega_weight)
            y, Y, mu[j] = y + i, Y + I, np.clip(mu_j, 1e-6, 1 - 1e-6)
        P = np.linalg.inv(Y)
        m = P @ y
        out.append((m, P))
    return np.array([m for m, _ in out]), np.array([P for _, P in out])


def loop_round(x, neighbours):
    """One round of averaging with Metropolis weights, node by node and neighbour by neighbour."""
    after = []
    for i, own in enumerate(x):
        value = own.copy()
        for j in neighbours[i]:
            value += (x[j] - own) / (1 + max(len(neighbours[i]), len(neighbours[j])))
        after.append(value)
    return np.array(after)


def within(graph, hops):
    """Of whom each node has heard after so many hops, by breadth-first search."""
    out = []
    for i in range(len(graph)):
        known = {i}
        for _ in range(hops):
            known |= {int(j) for k in known for j in np.flatnonzero(graph[k])}
        out.append(known)
    return out


# --- networks of tracker objects


def anchors_of(positions):
    return make_anchors(np.arange(1, len(positions) + 1), positions)


def network_of(config, positions):
    anchors = anchors_of(positions)
    return {int(i): ConsensusNode(config, anchors, int(i)) for i in anchors.ids}


def epoch_of(k, z):
    """Epoch k in which every node has read its row of z (N, 2)."""
    stamp = k * SECOND
    told = (R[0, 0], 0.0, 0.0, R[1, 1])
    packets = [RangeBearing(stamp, i, 1, k, k, *map(float, row), told) for i, row in enumerate(z, 1)]
    return Epoch(1, k, stamp, tuple(packets))
