"""The particles are the posterior that a dense grid computes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, FEW, epochs

from wsn_tracking.models.body import LOS, NLOS
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.walk import PSI, STATES, X, Y
from wsn_tracking.simulation.c_body import BodyConfig
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import HumanConfig, MotionConfig, StartConfig
from wsn_tracking.trackers.human_filter import HumanFilter
from wsn_tracking.trackers.human_models import curves_of


def test_it_is_the_grid_filter_of_its_model():
    """Random walk, two curves of which the likelier counts, on a corner of c_walk: a dense grid with 0.25 m cells."""
    config = HumanConfig(
        profile='paper_max',
        particles=20_000,
        area=(0.0, 0.0, 30.0, 30.0),
        motion=MotionConfig(kind='random_walk', step=1.0),
    )
    human, curves = HumanFilter(config, ANCHORS, (0.0, 0.0, 30.0, 30.0)), curves_of(config, ANCHORS)
    axis = np.arange(0.125, 30.0, 0.25)
    grid = np.stack(np.meshgrid(axis, axis, indexing='ij'))
    std = 1.0 * math.sqrt(0.5)
    kernel = np.exp(-0.5 * ((axis[:, None] - axis) / std) ** 2)
    kernel /= np.sqrt(2.0 * math.pi) * std / 0.25
    rng = np.random.default_rng(1)
    track, density = human.begin((), rng), np.full(grid.shape[1:], 1.0 / axis.size**2)
    place = np.array([14.0, 17.0])
    for k in range(8):
        if k:
            arrives = kernel @ density @ kernel.T
            stays = 1.0 - np.outer(kernel.sum(axis=0), kernel.sum(axis=0))  # who would leave stays where he was
            density = arrives + density * stays
        d = np.hypot(*(place[:, None] - ANCHORS.positions[:, :2].T))
        z = LOS.p_ref + LOS.k * np.log10(d) + 3.0 * rng.standard_normal(16)
        z[d > 50.0] = np.nan
        likelihood = np.zeros(density.shape)
        for i in np.flatnonzero(~np.isnan(z)):
            lg = np.log10(np.maximum(np.hypot(*(grid - ANCHORS.positions[i, :2, None, None])), 0.3))
            e = np.minimum(*(np.abs(z[i] - c.p_ref - c.k * lg) for c in (LOS, NLOS)))
            likelihood += -0.5 * (e / 3.0) ** 2 - math.log(3.0 * math.sqrt(2.0 * math.pi))
        density = density * np.exp(likelihood)
        evidence = density.sum()
        density /= evidence
        step = human.step(track, 0.5 if k else 0.0, Readings(z, np.full(16, 3.0), curves), rng)
        track = step.track
        mean = np.tensordot(grid, density, 2)
        spread = np.sqrt(np.tensordot((grid - mean[:, None, None]) ** 2, density, 2))
        # some 2000 particles count: a standard error of 0.02 deviations
        np.testing.assert_allclose(step.mean[:2], mean, atol=0.12 * spread.max())
        np.testing.assert_allclose(np.sqrt(np.diag(step.covariance)[:2]), spread, rtol=0.1)
        assert step.evidence == pytest.approx(math.log(evidence), abs=0.15)


def test_it_starts_where_the_first_epoch_says():
    """Mean and spread of the posterior of one epoch, places and directions even: on a grid of 1 m and 24 directions."""
    axis = np.arange(0.5, 100.0, 1.0)
    x, y, psi = (v.ravel() for v in np.meshgrid(axis, axis, math.pi * np.arange(24) / 12.0))
    s = np.zeros((STATES, x.size))
    s[X], s[Y], s[PSI] = x, y, psi
    for seed in range(3):
        sequence, _ = epochs(BodyConfig(duration=1.0), seed)
        config = replace(FEW, particles=5000, start=StartConfig(draws=40_000))
        tracker = HumanTracker(config, ANCHORS)
        (estimate,) = tracker.step(sequence[0])
        readings, _ = tracker._table.read(sequence[0])
        l = tracker._filter.score(s, readings).l
        w = np.exp(l - l.max())
        w /= w.sum()
        mean = np.array([w @ x, w @ y])
        spread = np.sqrt([w @ (x - mean[0]) ** 2, w @ (y - mean[1]) ** 2])
        np.testing.assert_allclose(estimate.mean[:2], mean, atol=0.15 * spread.max())  # some 500 draws count
        np.testing.assert_allclose(np.sqrt(np.diag(estimate.covariance)[:2]), spread, rtol=0.15)
