"""From a survey to a channel: path loss, map and ranging with their confidence intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wsn_tracking.models.anchors import Floats
from wsn_tracking.models.radio_map import RadioMap, make_map
from wsn_tracking.sensing.calibration import EXPONENTS
from wsn_tracking.sensing.channel import PathLoss, Quantity, Ranging
from wsn_tracking.sensing.field_fit import FieldFit, covariance_of, fit_field
from wsn_tracking.sensing.shrinkage import PopulationPrior
from wsn_tracking.sensing.survey import Survey

# What is known of radios before any data. P1 and n: any radio, indoors or out, n round the 2 of free space. Bias and
# scale: whatever antenna delays and clocks do. Spreads: nodes of one make, and count for two nodes against the data.
# Scatter: of rooms, and counts for eight places.
PATH_LOSS = PopulationPrior(np.array([-60.0, 2.0]), np.array([20.0, 1.0]), np.array([2.0, 0.3]), 3.0)
RANGING = PopulationPrior(np.array([0.0, 0.0]), np.array([0.5, 0.03]), np.array([0.05, 0.002]), 0.05)
OWN = 8.0  # places that the scatter of all nodes counts for beside a node's own
LEAST_FREEDOM = 3.0
FINE = 1e-6  # [dB] noise of a survey without any


def fit_path_loss(survey: Survey) -> tuple[PathLoss, RadioMap, dict[str, str]]:
    """Path loss of every node of a survey of signal strengths, the map, and how both do on places unseen.

    With d in metres, y = P1 - n 10 log10 d + field + fading + noise: see field.py for how and shrinkage.py for
    nodes with few places.
    """
    H = np.stack([np.ones(survey.distances.shape), -10.0 * np.log10(np.where(survey.known, survey.distances, 1.0))], -1)
    lines, field = fit_field(H, survey, PATH_LOSS, field=False), fit_field(H, survey, PATH_LOSS)
    p1, n = _quantities(lines, covariance_of(lines, field), field)
    loss = PathLoss(p1, _within(n, EXPONENTS), _one_reading(lines, field, survey), *_counts(survey))
    told = {'left_out': f'{left_out_rmse(lines):.2f} dB by path loss, {left_out_rmse(field):.2f} dB by the map'}
    return loss, _map(H, field, survey), told


def fit_ranging(survey: Survey) -> Ranging:
    """Bias and scale of every node of a survey of ranges: range - d = bias + (scale - 1) d + field + noise.

    The trend beside the field: what is to hold where the survey has not been, as after the first seconds of a bag.
    """
    H = np.stack([np.ones(survey.distances.shape), np.where(survey.known, survey.distances, 0.0)], -1)
    field = fit_field(H, survey, RANGING)
    bias, slope = _quantities(field, field.trends.cov, field)
    scale = Quantity(slope.value + 1.0, slope.std, slope.low + 1.0, slope.high + 1.0)
    return Ranging(bias, scale, _one_reading(field, field, survey), *_counts(survey))


def _map(H: Floats, fit: FieldFit, survey: Survey) -> RadioMap:
    p1, n = fit.trends.beta.T
    n = np.clip(n, *EXPONENTS)
    known = survey.known
    residual = np.where(known, survey.values - p1 - H[..., 1] * n, np.nan)
    noise = np.where(known, np.maximum(fit.noise, FINE), 1.0)
    heard = known.any(axis=1)  # a place where nobody heard anything says nothing
    points, residual, noise = survey.points[heard], residual[heard], noise[heard]
    amplitude, length, place = fit.hyper
    return make_map(
        survey.ids, p1, n, points, residual, noise, amplitude, length, place, np.maximum(fit.data.packet, FINE)
    )


def left_out_rmse(fit: FieldFit) -> float:
    """What places that were not seen are predicted to."""
    return float(np.sqrt(np.nanmean(np.square(fit.left_out))))


def _quantities(fit: FieldFit, cov: Floats, field: FieldFit) -> tuple[Quantity, ...]:
    """The coefficients of a fit, with their covariance (N, p, p)."""
    values = []
    for value, std in zip(fit.trends.beta.T, np.sqrt(np.diagonal(cov, axis1=-2, axis2=-1)).T, strict=True):
        half = _reach(field) * std
        values.append(Quantity(value, std, value - half, value + half))
    return tuple(values)


def _reach(fit: FieldFit) -> float:
    """Standard deviations to either end of a 95 % interval: Student's, for the scatter is estimated as well."""
    from scipy.stats import t

    N, p = fit.trends.beta.shape
    return float(t.ppf(0.975, max(fit.effective.sum() - N * (p - 1), LEAST_FREEDOM)))


def _within(q: Quantity, limits: tuple[float, float]) -> Quantity:
    low, high = limits
    return Quantity(np.clip(q.value, low, high), q.std, np.clip(q.low, low, high), np.clip(q.high, low, high))


def _one_reading(fit: FieldFit, field: FieldFit, survey: Survey) -> Quantity:
    """Standard deviation of one reading at a place not known: what places and packets scatter about the trend.

    A node's own scatter of places counts beside that of all, which counts for OWN places.
    """
    known = survey.known
    counts = np.where(known, survey.counts, 1.0)
    squares = np.where(known, fit.residual**2 - fit.data.packet**2 / counts, 0.0) * fit.data.trust
    places = known.sum(axis=0)
    common = max(float(squares.sum()) / max(int(places.sum()), 1), 0.0)
    variance = np.maximum((OWN * common + squares.sum(axis=0)) / (OWN + places), 0.0)
    sigma = np.sqrt(variance + fit.data.packet**2)
    sigma = np.maximum(sigma, FINE)
    doubt = 2.0 * variance**2 / (OWN + field.effective) + 2.0 * fit.data.packet**4 / np.maximum(fit.packet_freedom, 1.0)
    std = np.sqrt(doubt) / (2.0 * sigma)
    half = _reach(field) * std
    return Quantity(sigma, std, np.maximum(sigma - half, 0.0), sigma + half)


def _counts(survey: Survey) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    known = survey.known
    readings: Floats = np.where(known & np.isfinite(survey.counts), survey.counts, 0.0).sum(axis=0)
    return known.sum(axis=0).astype(np.int64), np.rint(readings).astype(np.int64)
