"""From a survey to a channel: path loss, map and ranging with their confidence intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.radio_map import RadioMap, make_map
from wsn_tracking.sensing.channel import PathLoss, Quantity, Ranging
from wsn_tracking.sensing.field import FieldFit, fit_field
from wsn_tracking.sensing.shrinkage import PopulationPrior
from wsn_tracking.sensing.survey import Survey

# What is known of radios before any data. P1 and n: any radio, indoors or out, n round the 2 of free space. Bias and
# scale: whatever antenna delays and clocks do. Spreads: nodes of one make, and count for two nodes against the data.
PATH_LOSS = PopulationPrior(np.array([-60.0, 2.0]), np.array([20.0, 1.0]), np.array([2.0, 0.3]))
RANGING = PopulationPrior(np.array([0.0, 0.0]), np.array([1.0, 0.1]), np.array([0.05, 0.005]))
EXPONENTS = (0.5, 6.0)  # below: a wave guide; above: no indoor measurement says so
OWN = 8.0  # places that the scatter of all nodes counts for beside a node's own
LEAST_FREEDOM = 3.0
FINE = 1e-6  # [dB] noise of a survey without any


def fit_path_loss(survey: Survey) -> tuple[PathLoss, RadioMap, dict[str, str]]:
    """Path loss of every node of a survey of signal strengths, the map about it, and how both do on places unseen.

    With d in metres, y = P1 - n 10 log10 d + field + fading + noise: see field.py for how and shrinkage.py for
    nodes with few places.
    """
    H = np.stack([np.ones(survey.distances.shape), -10.0 * np.log10(np.where(survey.known, survey.distances, 1.0))], -1)
    fit = fit_field(H, survey, PATH_LOSS)
    p1, n = _quantity(fit, 0), _quantity(fit, 1)
    loss = PathLoss(p1, _within(n, EXPONENTS), _one_reading(fit, survey), *_counts(survey))
    known = survey.known
    residual = np.where(known, survey.values - loss.p1_dbm.value - H[..., 1] * loss.n.value, np.nan)
    noise = np.where(known, np.maximum(fit.noise, FINE), 1.0)
    place = np.full(survey.ids.size, fit.hyper.place)
    heard = known.any(axis=1)  # a place where nobody heard anything says nothing
    radio_map = make_map(
        survey.ids,
        survey.points[heard],
        residual[heard],
        noise[heard],
        fit.hyper.amplitude,
        fit.hyper.length,
        place,
        np.maximum(fit.packet, FINE),
    )
    alone = fit_field(H, survey, PATH_LOSS, field=False)
    told = {'left_out': f'{left_out_rmse(alone):.2f} dB by path loss, {left_out_rmse(fit):.2f} dB with the map'}
    return loss, radio_map, told


def fit_ranging(survey: Survey) -> Ranging:
    """Bias and scale of every node of a survey of ranges: range - d = bias + (scale - 1) d + field + noise."""
    H = np.stack([np.ones(survey.distances.shape), np.where(survey.known, survey.distances, 0.0)], -1)
    fit = fit_field(H, survey, RANGING)
    slope = _quantity(fit, 1)
    scale = Quantity(slope.value + 1.0, slope.std, slope.low + 1.0, slope.high + 1.0)
    return Ranging(_quantity(fit, 0), scale, _one_reading(fit, survey), *_counts(survey))


def left_out_rmse(fit: FieldFit) -> float:
    """What places that were not seen are predicted to."""
    return float(np.sqrt(np.nanmean(np.square(fit.left_out))))


def _quantity(fit: FieldFit, column: int) -> Quantity:
    value = fit.trends.beta[:, column]
    std = np.sqrt(fit.trends.cov[:, column, column])
    half = _reach(fit) * std
    return Quantity(value, std, value - half, value + half)


def _reach(fit: FieldFit) -> float:
    """Standard deviations to either end of a 95 % interval: Student's, for the scatter is estimated as well."""
    from scipy.stats import t

    N, p = fit.trends.beta.shape
    return float(t.ppf(0.975, max(fit.effective.sum() - N * (p - 1), LEAST_FREEDOM)))


def _within(q: Quantity, limits: tuple[float, float]) -> Quantity:
    low, high = limits
    return Quantity(np.clip(q.value, low, high), q.std, np.clip(q.low, low, high), np.clip(q.high, low, high))


def _one_reading(fit: FieldFit, survey: Survey) -> Quantity:
    """Standard deviation of one reading at a place not known: what places and packets scatter about the trend.

    A node's own scatter of places counts beside that of all, which counts for OWN places.
    """
    known = survey.known
    counts = np.where(known, survey.counts, 1.0)
    squares = np.where(known, fit.residual**2 - fit.packet**2 / counts, 0.0) * fit.trust
    places = known.sum(axis=0)
    common = max(float(squares.sum()) / max(int(places.sum()), 1), 0.0)
    variance = np.maximum((OWN * common + squares.sum(axis=0)) / (OWN + places), 0.0)
    sigma = np.sqrt(variance + fit.packet**2)
    sigma = np.maximum(sigma, FINE)
    std = variance * np.sqrt(2.0 / (OWN + fit.effective)) / (2.0 * sigma)
    half = _reach(fit) * std
    return Quantity(sigma, std, np.maximum(sigma - half, 0.0), sigma + half)


def _counts(survey: Survey) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    known = survey.known
    readings: Floats = np.where(known, survey.counts, 0.0).sum(axis=0)
    return known.sum(axis=0).astype(np.int64), np.rint(readings).astype(np.int64)
