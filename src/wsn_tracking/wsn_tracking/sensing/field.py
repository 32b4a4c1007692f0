"""A trend per node and a random field about it, from a survey: what a calibration estimates.

Node k reads at place j: y_jk = H_jk beta_k + f_k(x_j) + e_jk. The trend beta_k belongs to a population (see
shrinkage.py), the field f_k is a Gaussian process with Matérn 3/2 covariance, the noise e_jk is fading from place to
place and the mean of n_jk packets: place^2 + packet_k^2 / n_jk. Amplitude, length and place are shared by all nodes
and maximise the marginal likelihood, trends integrated out. Neighbouring places say the same of the trend, which the
field knows: without it the intervals of the trend would be far too narrow.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.matern import matern
from wsn_tracking.sensing.robust_fit import FAR, outlier_weights
from wsn_tracking.sensing.shrinkage import PopulationPrior, Shrunk, shrink
from wsn_tracking.sensing.survey import Survey

ROUNDS = 3  # hyperparameters, trends, trust: then the next
LENGTH = 3.0  # [m] of the field before any data: as wide as a room
LENGTH_FACTOR, SCALE_FACTOR = 2.5, 3.0  # what one standard deviation of these guesses multiplies or divides by
LEAST_SHARE = 1e-3  # of the readings' scale: smaller amplitudes and noises make no difference
MANY = 100.0  # packets at one place; more tell no more of their scatter
TAIL = 3.0  # scatter beyond this many times the median's is another wrong reading


class Hyper(NamedTuple):
    """What is shared by all nodes, in the unit of the readings and in metres."""

    amplitude: float
    length: float
    place: float


class FieldFit(NamedTuple):
    """Trends, field and noise of a survey."""

    trends: Shrunk
    hyper: Hyper
    packet: Floats  # (N,) standard deviation of packets at one place
    residual: Floats  # (K, N) reading minus trend; NaN: unknown
    noise: Floats  # (K, N) standard deviation with which each reading tells the field; larger for wrong ones
    trust: Floats  # (K, N) 1, less for readings that look wrong
    effective: Floats  # (N,) independent places that the readings of a node are worth
    left_out: Floats  # (K, N) reading minus what all others predict; NaN: unknown
    left_out_std: Floats  # (K, N) what that should be


def fit_field(H: Floats, survey: Survey, prior: PopulationPrior, *, field: bool = True) -> FieldFit:
    """Fit design H (K, N, p), whose first column is one; without `field` all places are independent.

    Readings beyond FAR standard deviations from what all others predict are trusted less.
    """
    known = survey.known
    H = np.where(known[..., None], H, 0.0)
    y = np.where(known, survey.values, 0.0)
    counts = np.where(known, survey.counts, 1.0)
    packet = packet_std(survey)
    trust, scale = outlier_weights(H, y, known, counts / (counts + 1.0), prior)
    typical = float(np.median(scale))
    R = matern(survey.points, survey.points, _start(typical).length)
    hyper = _start(typical) if field else Hyper(0.0, LENGTH, typical)
    trends: Shrunk | None = None
    for _ in range(ROUNDS):
        hyper = _most_likely(hyper, H, y, known, counts, packet, trust, prior, trends, survey.points, typical, field)
        R = matern(survey.points, survey.points, hyper.length)
        noise = _noise(hyper, packet, counts, trust)
        L = _root(R, hyper.amplitude, noise, known)
        Hw, yw = _whiten(L, H), _whiten(L, y[..., None])[..., 0]
        trends = shrink(np.swapaxes(Hw, -1, -2) @ Hw, np.einsum('nki,nk->ni', Hw, yw), prior)
        left_out, std = _left_out(R, hyper.amplitude, noise, known, H, y, trends)
        with np.errstate(invalid='ignore'):
            trust = np.where(known, np.minimum(trust, np.maximum(np.abs(left_out) / (FAR * std), 1.0) ** -2.0), 1.0)
    assert trends is not None
    residual = np.where(known, y - np.einsum('kni,ni->kn', H, trends.beta), np.nan)
    ones = _whiten(L, known[..., None].astype(np.float64))[..., 0]
    effective = np.square(ones).sum(axis=-1) * (hyper.amplitude**2 + hyper.place**2)
    return FieldFit(trends, hyper, packet, residual, noise, trust, effective, left_out, std)


def packet_std(survey: Survey) -> Floats:
    """Standard deviation of a node's packets at one place (N,); 0 where no place has two of them.

    Pooled over the places. What scatters more than TAIL times as much as half of them do counts as that much;
    a node with few packets is helped by the others.
    """
    known = survey.known & np.isfinite(survey.scatter)
    w = np.where(known, np.minimum(survey.counts, MANY) - 1.0, 0.0)
    if not np.any(w > 0.0):
        return np.zeros(survey.ids.size)
    squares = np.where(known, survey.scatter, 0.0) ** 2
    limit = TAIL**2 * float(np.median(squares[w > 0.0]))
    squares = np.minimum(squares, limit) if limit > 0.0 else squares
    common = float(np.average(squares, weights=w))
    own = MANY * common + (w * squares).sum(axis=0)
    return np.asarray(np.sqrt(own / (MANY + w.sum(axis=0))))


def _start(scale: float) -> Hyper:
    """Half of the variance in the field, half from place to place."""
    return Hyper(scale * np.sqrt(0.5), LENGTH, scale * np.sqrt(0.5))


def _noise(hyper: Hyper, packet: Floats, counts: Floats, trust: Floats) -> Floats:
    return np.asarray(np.sqrt((hyper.place**2 + packet**2 / counts) / trust))


def _root(R: Floats, amplitude: float, noise: Floats, known: NDArray[np.bool_]) -> Floats:
    """Cholesky factor (N, K, K) of each node's covariance; a row without reading stands alone with unit variance."""
    links = known.T[:, :, None] & known.T[:, None, :]
    diagonal = np.where(known, noise**2, 1.0).T
    return np.linalg.cholesky(links * (amplitude**2 * R) + np.eye(len(R)) * diagonal[:, :, None])


def _whiten(L: Floats, columns: Floats) -> Floats:
    """L^-1 of columns (K, N, m), as (N, K, m)."""
    return np.linalg.solve(L, np.swapaxes(columns, 0, 1))


def _most_likely(
    start: Hyper,
    H: Floats,
    y: Floats,
    known: NDArray[np.bool_],
    counts: Floats,
    packet: Floats,
    trust: Floats,
    prior: PopulationPrior,
    trends: Shrunk | None,
    points: Floats,
    scale: float,
    field: bool,
) -> Hyper:
    """Hyperparameters at the maximum of marginal likelihood times a broad guess (log-normal), trends integrated out."""
    from scipy.optimize import minimize

    if trends is None:
        mean, spread = prior.mean, np.diag(np.square(prior.std) + np.square(prior.spread))
    else:
        mean, spread = trends.mean, trends.spread
    centred = y - np.einsum('kni,i->kn', H, mean)
    columns = np.concatenate([H, centred[..., None]], axis=-1)
    root_T = np.linalg.cholesky(spread)
    guess = _start(scale)
    count = 3 if field else 1

    def hyper_of(theta: Floats) -> Hyper:
        values = np.exp(theta)
        return Hyper(float(values[1]), float(values[2]), float(values[0])) if field else Hyper(0.0, LENGTH, *values)

    def cost(theta: Floats) -> float:
        hyper = hyper_of(theta)
        L = _root(matern(points, points, hyper.length), hyper.amplitude, _noise(hyper, packet, counts, trust), known)
        white = _whiten(L, columns)
        Hw, e = white[..., :-1] @ root_T, white[..., -1]
        B = np.eye(H.shape[-1]) + np.swapaxes(Hw, -1, -2) @ Hw
        g = np.einsum('nki,nk->ni', Hw, e)
        quadratic = np.square(e).sum() - np.einsum('ni,ni->', g, np.linalg.solve(B, g[..., None])[..., 0])
        logs = 2.0 * np.log(np.diagonal(L, axis1=-2, axis2=-1)).sum() + np.linalg.slogdet(B)[1].sum()
        broad = ((theta - centre) / widths) ** 2
        return float(0.5 * (quadratic + logs + broad.sum()))

    centre = np.log([guess.place, guess.amplitude, guess.length])[:count]
    widths = np.log([SCALE_FACTOR, SCALE_FACTOR, LENGTH_FACTOR])[:count]
    least = np.log(LEAST_SHARE * scale)
    bounds = [(least, None), (least, None), (np.log(0.05 * LENGTH), np.log(100.0 * LENGTH))][:count]
    first = np.log([start.place, max(start.amplitude, LEAST_SHARE * scale), start.length])[:count]
    best = minimize(cost, first, method='L-BFGS-B', bounds=bounds, options={'maxiter': 60})
    return hyper_of(best.x)


def _left_out(
    R: Floats,
    amplitude: float,
    noise: Floats,
    known: NDArray[np.bool_],
    H: Floats,
    y: Floats,
    trends: Shrunk,
) -> tuple[Floats, Floats]:
    """Each reading minus what all others of its node predict, and the standard deviation of that, (K, N) each.

    The population stands for the node's trend, so that one reading does not speak through it twice (Rasmussen and
    Williams 2006, eq. 5.12, of the covariance with the trend in it).
    """
    C = _root(R, amplitude, noise, known)
    C = C @ np.swapaxes(C, -1, -2)
    Hn = np.swapaxes(H, 0, 1)
    full = C + Hn @ (trends.spread + trends.mean_cov) @ np.swapaxes(Hn, -1, -2)
    precision = np.linalg.solve(full, np.broadcast_to(np.eye(len(R)), full.shape))
    variance = 1.0 / np.diagonal(precision, axis1=-2, axis2=-1)
    centred = (y - np.einsum('kni,i->kn', H, trends.mean)).T
    left_out = (precision @ centred[..., None])[..., 0] * variance
    return np.where(known, left_out.T, np.nan), np.where(known, np.sqrt(variance).T, np.nan)
