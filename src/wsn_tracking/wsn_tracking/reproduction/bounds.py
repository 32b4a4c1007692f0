"""What a filter can hardly beat: the Cramer-Rao recursion along the true path of each run."""

from __future__ import annotations

import numpy as np

from wsn_tracking.filters.linalg import transpose
from wsn_tracking.models.anchors import Floats


def path_bound(P0: Floats, F: Floats, Q: Floats, information: Floats) -> Floats:
    """Covariances (..., K, n, n) of x_k = F x_k-1 + w, w ~ N(0, Q), from x_0 ~ N(m, P0), by the run's own information.

    F and Q (n, n), or (..., K, n, n) of the steps that begin in epoch k; F at the true state where motion bends.
    information (..., K, n, n): H' R^-1 H of epoch k's readings, H at the true state. J_0 = P0^-1 + I_0,
    J_k = (F J_k-1^-1 F' + Q)^-1 + I_k (Tichavsky, Muravchik, Nehorai 1998, with the expectation over states left to the
    mean over runs): the covariance of a Kalman filter that is linearised at the truth. Where all paths see the same
    geometry, it is the posterior Cramer-Rao bound.
    """
    bounds = np.empty_like(information)
    predicted, unit = np.broadcast_to(P0, information[..., 0, :, :].shape), np.eye(len(P0))
    F, Q = (np.broadcast_to(step, information.shape) for step in (F, Q))
    for k in range(information.shape[-3]):
        P = np.linalg.solve(unit + predicted @ information[..., k, :, :], predicted)
        bounds[..., k, :, :] = 0.5 * (P + transpose(P))
        predicted = F[..., k, :, :] @ P @ transpose(F[..., k, :, :]) + Q[..., k, :, :]
    return bounds


def range_bearing_information(positions: Floats, states: Floats, arrived: Floats, R: Floats) -> Floats:
    """H' R^-1 H (..., 4, 4) of ranges and bearings that nodes at positions (..., N, >= 2) take of states (..., 4).

    arrived (..., N): 1 where the node's reading is one of the target, else 0; R (2, 2) is diagonal.
    """
    d = states[..., None, :2] - positions[..., :2]
    square = np.sum(d**2, axis=-1)
    H = np.zeros((*d.shape[:-1], 2, states.shape[-1]))
    H[..., 0, :2] = d / np.sqrt(square)[..., None]
    H[..., 1, :2] = np.stack([-d[..., 1], d[..., 0]], axis=-1) / square[..., None]
    weight = arrived[..., None] / np.diagonal(R)
    return np.asarray(np.einsum('...nri,...nr,...nrj->...ij', H, weight, H))


def scalar_information(nodes: Floats, states: Floats, weights: Floats, inverse_distance: bool = False) -> Floats:
    """The same of distances, or of their natural logarithms (`inverse_distance`), from nodes (..., N, >= 2).

    weights (..., N): one over the variance of each reading, 0 where there is none.
    """
    d = states[..., None, :2] - nodes[..., :2]
    square = np.sum(d**2, axis=-1)
    H = np.zeros((*d.shape[:-1], states.shape[-1]))
    H[..., :2] = d / (square if inverse_distance else np.sqrt(square))[..., None]
    return np.asarray(np.einsum('...ni,...n,...nj->...ij', H, weights, H))
