"""A trend per node and a random field about it, from a survey: what a calibration estimates.

Node k reads at place j: y_jk = H_jk beta_k + f_k(x_j) + e_jk. The trend beta_k belongs to a population (see
shrinkage.py), the field f_k is a Gaussian process with Matérn 3/2 covariance, the noise e_jk is fading from place to
place and the mean of n_jk packets: place^2 + packet_k^2 / n_jk. Amplitude, length and place are shared by all nodes
and maximise the marginal likelihood, trends integrated out.

With the field, the trend is what remains when the field has its share. Without, it is the line that is nearest to the
readings all over the surveyed places, which is what a tracker without a map needs; but neighbouring places say the same
of it, and only the field knows how much: `covariance_of` asks it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.matern import matern

LENGTH = 3.0  # [m] of the field before any data: as wide as a room
LENGTH_FACTOR, SCALE_FACTOR = 2.5, 3.0  # what one standard deviation of these guesses multiplies or divides by
LENGTHS = (0.15, 300.0)  # [m] that are considered
SHARES = (1e-3, 1e3)  # of the readings' scale, for amplitude and noise: beyond, nothing changes
PASSES = 60


class Hyper(NamedTuple):
    """What is shared by all nodes, in the unit of the readings and in metres."""

    amplitude: float  # standard deviation of the field; 0: there is none
    length: float
    place: float  # standard deviation from place to place


class Data(NamedTuple):
    """Readings y and their design H, a row a place, a column a node; zeros where a node heard nothing."""

    points: Floats  # (K, 2) [m]
    H: Floats  # (K, N, p)
    y: Floats  # (K, N)
    known: NDArray[np.bool_]  # (K, N)
    counts: Floats  # (K, N) packets that each is the mean of, 1 or more
    packet: Floats  # (N,) standard deviation of packets at one place
    trust: Floats  # (K, N) in (0, 1]: noise variances are divided by it


def start(scale: float, *, field: bool) -> Hyper:
    """A guess: half of the readings' variance in the field, half from place to place."""
    half = float(np.sqrt(0.5)) * scale
    return Hyper(half, LENGTH, half) if field else Hyper(0.0, LENGTH, scale)


def noise_std(hyper: Hyper, data: Data) -> Floats:
    """Standard deviation (K, N) with which each reading tells trend and field."""
    return np.asarray(np.sqrt((hyper.place**2 + data.packet**2 / data.counts) / data.trust))


def covariance(hyper: Hyper, data: Data) -> Floats:
    """Covariance (N, K, K) of each node's readings about its trend; an unknown one stands alone with variance 1."""
    links = data.known.T[:, :, None] & data.known.T[:, None, :]
    diagonal = np.where(data.known, noise_std(hyper, data) ** 2, 1.0).T
    shared = hyper.amplitude**2 * matern(data.points, data.points, hyper.length)
    return np.asarray(links * shared + np.eye(len(data.points)) * diagonal[:, :, None])


def whiten(L: Floats, columns: Floats) -> Floats:
    """L^-1 of columns (K, N, m), as (N, K, m)."""
    return np.asarray(np.linalg.solve(L, np.swapaxes(columns, 0, 1)))


def cost(hyper: Hyper, data: Data, mean: Floats, spread: Floats) -> float:
    """Minus the logarithm of the marginal likelihood, up to a constant, of trends beta ~ N(mean, spread)."""
    away = data.y - np.einsum('kni,i->kn', data.H, mean)
    white = whiten(L := np.linalg.cholesky(covariance(hyper, data)), np.concatenate([data.H, away[..., None]], axis=-1))
    Hw, e = white[..., :-1] @ np.linalg.cholesky(spread), white[..., -1]
    B = np.eye(Hw.shape[-1]) + np.swapaxes(Hw, -1, -2) @ Hw
    g = np.einsum('nki,nk->ni', Hw, e)
    quadratic = np.square(e).sum() - np.einsum('ni,ni->', g, np.linalg.solve(B, g[..., None])[..., 0])
    logs = 2.0 * np.log(np.diagonal(L, axis1=-2, axis2=-1)).sum() + np.linalg.slogdet(B)[1].sum()
    return float(0.5 * (quadratic + logs))


def most_likely(first: Hyper, data: Data, mean: Floats, spread: Floats, scale: float) -> Hyper:
    """Hyperparameters at the maximum of marginal likelihood times a broad log-normal guess, searched from `first`."""
    from scipy.optimize import minimize

    field = first.amplitude > 0.0
    guess = start(scale, field=field)

    def order(hyper: Hyper) -> list[float]:
        return [hyper.place, hyper.amplitude, hyper.length] if field else [hyper.place]

    def hyper_of(theta: Floats) -> Hyper:
        values: list[float] = np.exp(theta).tolist()
        return Hyper(values[1], values[2], values[0]) if field else guess._replace(place=values[0])

    centre = np.log(order(guess))
    widths = np.log([SCALE_FACTOR, SCALE_FACTOR, LENGTH_FACTOR])[: centre.size]

    def posterior(theta: Floats) -> float:
        doubt = np.square((theta - centre) / widths).sum()
        return cost(hyper_of(theta), data, mean, spread) + 0.5 * float(doubt)

    shares = np.log(scale) + np.log(SHARES)
    bounds = np.stack([shares, shares, np.log(LENGTHS)])[: centre.size]
    found = minimize(posterior, np.log(order(first)), method='L-BFGS-B', bounds=bounds, options={'maxiter': PASSES})
    return hyper_of(found.x)


def left_out(hyper: Hyper, data: Data, mean: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """Each reading minus what all others of its node predict, and its standard deviation, (K, N); NaN: unknown.

    The trend is N(mean, spread) before the node's readings, so that none speaks through it twice (Rasmussen and
    Williams 2006, eq. 5.12, of the covariance with the trend in it).
    """
    H = np.swapaxes(data.H, 0, 1)
    full = covariance(hyper, data) + H @ spread @ np.swapaxes(H, -1, -2)
    precision = np.linalg.solve(full, np.broadcast_to(np.eye(len(data.points)), full.shape))
    variance = 1.0 / np.diagonal(precision, axis1=-2, axis2=-1)
    away = (data.y - np.einsum('kni,i->kn', data.H, mean)).T
    error = (precision @ away[..., None])[..., 0] * variance
    return np.where(data.known, error.T, np.nan), np.where(data.known, np.sqrt(variance).T, np.nan)
