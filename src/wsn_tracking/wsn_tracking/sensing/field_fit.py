"""Fit trends, field and noise to a survey (field.py), readings that look wrong counting less."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wsn_tracking.models.anchors import Floats
from wsn_tracking.sensing.field import Data, Hyper, covariance, left_out, most_likely, noise_std, start, whiten
from wsn_tracking.sensing.robust_fit import FAR, outlier_weights, packet_std
from wsn_tracking.sensing.shrinkage import PopulationPrior, Shrunk, precision_of, shrink
from wsn_tracking.sensing.survey import Survey

ROUNDS = 3  # hyperparameters, trends, trust: then the next


class FieldFit(NamedTuple):
    """Trends, field and noise of a survey."""

    trends: Shrunk
    hyper: Hyper
    data: Data
    packet_freedom: Floats  # (N,) readings beyond the first of each place, which tell data.packet
    residual: Floats  # (K, N) reading minus trend; NaN: unknown
    noise: Floats  # (K, N) standard deviation with which each reading counts
    left_out: Floats  # (K, N) reading minus what all others predict; NaN: unknown
    left_out_std: Floats  # (K, N) what that should be

    @property
    def effective(self) -> Floats:
        """Independent places that the readings of each node are worth, (N,): as many as known ones without field."""
        known = self.data.known
        L = np.linalg.cholesky(covariance(self.hyper, self.data))
        ones = whiten(L, known[..., None].astype(np.float64))[..., 0]
        precision = (np.where(known, self.noise, np.inf) ** -2.0).sum(axis=0)
        typical = known.sum(axis=0) / np.maximum(precision, 1e-300)
        return np.asarray(np.square(ones).sum(axis=-1) * (self.hyper.amplitude**2 + typical))


def fit_field(H: Floats, survey: Survey, prior: PopulationPrior, *, field: bool = True) -> FieldFit:
    """Fit design H (K, N, p), whose first column is one; without `field` all places are independent.

    Readings beyond FAR standard deviations from what all others predict count as if they had a standard deviation
    so much larger.
    """
    known = survey.known
    H = np.where(known[..., None], H, 0.0)
    y = np.where(known, survey.values, 0.0)
    counts = np.where(known, survey.counts, 1.0)
    packet, freedom = packet_std(survey)
    trust, scales = outlier_weights(H, y, known, 1.0 / (1.0 + 1.0 / counts), prior)
    scale = float(np.median(scales))
    data = Data(survey.points, H, y, known, counts, packet, trust)
    hyper = start(scale, field=field)
    mean, spread = prior.mean, np.diag(np.square(prior.std) + np.square(prior.spread))
    for _ in range(ROUNDS):
        hyper = most_likely(hyper, data, mean, spread, scale)
        L = np.linalg.cholesky(covariance(hyper, data))
        Hw, yw = whiten(L, H), whiten(L, y[..., None])[..., 0]
        trends = shrink(np.swapaxes(Hw, -1, -2) @ Hw, np.einsum('nki,nk->ni', Hw, yw), prior)
        mean, spread = trends.mean, trends.spread
        noise = noise_std(hyper, data)
        error, std = left_out(hyper, data, mean, spread + trends.mean_cov)
        with np.errstate(invalid='ignore'):
            size = np.where(known, np.abs(error) / std, 0.0)
        data = data._replace(trust=np.minimum(trust, np.maximum(size / FAR, 1.0) ** -2.0))
    residual = np.where(known, y - np.einsum('kni,ni->kn', H, trends.beta), np.nan)
    return FieldFit(trends, hyper, data, freedom, residual, noise, error, std)


def covariance_of(lines: FieldFit, field: FieldFit) -> Floats:
    """Covariance (N, p, p) of the trends of a fit without field, if the readings are as the fit with field says.

    V (H' W C W H + T^-1 + T^-1 M T^-1) V for the trend V (H' W y + T^-1 mean), readings of covariance C, a population
    of spread T whose mean has covariance M: with C = W^-1 it is the covariance that `lines` itself has.
    """
    H = lines.data.H
    WH = np.swapaxes(H / np.square(lines.noise)[..., None], 0, 1)
    T = precision_of(lines.trends.spread)
    V = precision_of(np.einsum('kni,nkj->nij', H, WH) + T)
    C = covariance(field.hyper, field.data)
    middle = np.swapaxes(WH, -1, -2) @ C @ WH + T + T @ lines.trends.mean_cov @ T
    return np.asarray(V @ middle @ V)
