"""A radio map: each node's path loss, and how far its signal strength is from that, place by place.

Per node a Gaussian process over the plane (Rasmussen and Williams 2006, chapter 2) that has seen the residuals of a
survey. Amplitude and length are shared, so that one vector of correlations serves all nodes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wsn_tracking.models.anchors import Anchors, Floats
from wsn_tracking.models.matern import matern
from wsn_tracking.models.radio import rssi_at

STEPS = 4.0  # lattice steps a length: between them the standard deviation is right to a few percent of the amplitude
BEYOND = 2.0  # lengths by which the lattice goes beyond the survey, where it knows nothing any more
MOST_STEPS = 200  # along one axis


class Lattice(NamedTuple):
    """The map's own standard deviation on a grid, for interpolation."""

    origin: Floats  # (2,) [m]
    step: float  # [m]
    std_db: Floats  # (X, Y, N)


class RadioMap(NamedTuple):
    """What a survey tells of signal strengths, one column a node."""

    ids: NDArray[np.int64]  # (N,) ascending
    p1_dbm: Floats  # (N,) its path loss, at 1 m
    n: Floats  # (N,)
    points: Floats  # (K, 2) [m] of the survey
    residual_db: Floats  # (K, N) surveyed signal strength minus path loss; NaN: not surveyed
    noise_db: Floats  # (K, N) standard deviation with which each tells the field
    amplitude_db: float  # standard deviation of the field
    length: float  # [m]
    place_db: Floats  # (N,) standard deviation from place to place that the field does not follow: fading
    packet_db: Floats  # (N,) standard deviation of packets at one place
    weights: Floats  # (K, N) [dB] of the correlations with the points
    lattice: Lattice


def make_map(
    ids: ArrayLike,
    p1_dbm: ArrayLike,
    n: ArrayLike,
    points: ArrayLike,
    residual_db: ArrayLike,
    noise_db: ArrayLike,
    amplitude_db: float,
    length: float,
    place_db: ArrayLike,
    packet_db: ArrayLike,
) -> RadioMap:
    """The map of a survey: fields as in RadioMap, those of (N,) may be scalars; ids ascending."""
    ids = np.asarray(ids, dtype=np.int64)
    points = np.asarray(points, dtype=np.float64)
    y = np.asarray(residual_db, dtype=np.float64)
    noise = np.broadcast_to(np.asarray(noise_db, dtype=np.float64), y.shape)
    columns = (np.asarray(each, dtype=np.float64) for each in (p1_dbm, n, place_db, packet_db))
    p1, exponent, place, packet = (np.broadcast_to(column, ids.shape).copy() for column in columns)
    known = np.isfinite(y)
    # A value that is missing becomes a row of its own, without a link to the field: it tells nothing.
    links = (known.T[:, :, None] & known.T[:, None, :]) * amplitude_db**2
    C = links * matern(points, points, length) + np.eye(len(points)) * np.where(known, noise**2, 1.0).T[:, :, None]
    L = np.linalg.cholesky(C)
    whitened = np.linalg.solve(L, np.where(known, y, 0.0).T[..., None])
    weights = amplitude_db**2 * np.linalg.solve(np.swapaxes(L, -1, -2), whitened)[..., 0].T
    lattice = _lattice(points, known, amplitude_db, length, L)
    return RadioMap(
        ids, p1, exponent, points, y, noise, float(amplitude_db), float(length), place, packet, weights, lattice
    )


def _lattice(points: Floats, known: NDArray[np.bool_], amplitude: float, length: float, L: Floats) -> Lattice:
    low, high = points.min(axis=0) - BEYOND * length, points.max(axis=0) + BEYOND * length
    step = max(length / STEPS, float((high - low).max()) / MOST_STEPS)
    size = np.ceil((high - low) / step).astype(np.int64) + 1
    x, y = (low[i] + step * np.arange(size[i]) for i in (0, 1))
    places = np.stack(np.meshgrid(x, y, indexing='ij'), axis=-1)
    c = amplitude**2 * matern(places.reshape(-1, 2), points, length)
    std = np.empty((len(c), known.shape[1]))
    for node in range(known.shape[1]):
        told = np.linalg.solve(L[node], (c * known[:, node]).T)
        std[:, node] = np.sqrt(np.maximum(amplitude**2 - np.einsum('ij,ij->j', told, told), 0.0))
    return Lattice(low, step, std.reshape(*size, -1))


def aligned(radio_map: RadioMap, anchors: Anchors) -> RadioMap:
    """The map with the columns of a table of nodes; those that it lacks have their own path loss and sigma_db."""
    place = {node: column for column, node in enumerate(radio_map.ids.tolist())}
    column = np.array([place.get(node, -1) for node in anchors.ids.tolist()])
    there = column >= 0
    return radio_map._replace(
        ids=anchors.ids,
        p1_dbm=np.where(there, radio_map.p1_dbm[column], rssi_at(anchors, 1.0)),
        n=np.where(there, radio_map.n[column], anchors.n),
        residual_db=np.where(there, radio_map.residual_db[:, column], np.nan),
        noise_db=np.where(there, radio_map.noise_db[:, column], 1.0),
        place_db=np.where(there, radio_map.place_db[column], 0.0),
        packet_db=np.where(there, radio_map.packet_db[column], anchors.sigma_db),
        weights=radio_map.weights[:, column] * there,
        lattice=radio_map.lattice._replace(std_db=radio_map.lattice.std_db[..., column] * there),
    )


def residual_mean(radio_map: RadioMap, states: Floats) -> Floats:
    """Expected signal strength minus path loss (..., N) [dB] at states (..., n) [m]; 0 far from the survey."""
    return matern(states, radio_map.points, radio_map.length) @ radio_map.weights


def residual_std(radio_map: RadioMap, states: Floats) -> Floats:
    """Standard deviation (..., N) [dB] of the field about `residual_mean`: the amplitude far from the survey.

    Exact on the lattice, interpolated bilinearly between its points.
    """
    origin, step, std = radio_map.lattice
    most = np.array(std.shape[:2]) - 1
    u = np.clip((states[..., :2] - origin) / step, 0.0, most)
    cell = np.minimum(u.astype(np.int64), most - 1)
    f = (u - cell)[..., None]
    i, j = cell[..., 0], cell[..., 1]
    across = std[i, j] + f[..., 1, :] * (std[i, j + 1] - std[i, j])
    beyond = std[i + 1, j] + f[..., 1, :] * (std[i + 1, j + 1] - std[i + 1, j])
    return np.asarray(across + f[..., 0, :] * (beyond - across))


def residual(radio_map: RadioMap, states: Floats) -> tuple[Floats, Floats]:
    """Mean and standard deviation of the field, (..., N) [dB] each, at states (..., n)."""
    return residual_mean(radio_map, states), residual_std(radio_map, states)
