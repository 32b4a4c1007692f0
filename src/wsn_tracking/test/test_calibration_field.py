"""Path loss and field: known parameters come back, within their intervals, as often as stated."""

from __future__ import annotations

import numpy as np
import pytest
from survey_cases import NODES, covered, field, places, strengths, surveyed, world

from wsn_tracking.models.measurement import mapped_rssi_function
from wsn_tracking.models.radio_map import residual_std
from wsn_tracking.sensing.channel_fit import PATH_LOSS, fit_path_loss
from wsn_tracking.sensing.field_fit import fit_field


@pytest.mark.parametrize(('amplitude', 'low'), [(0.0, 0.93), (3.0, 0.90)])
def test_intervals_of_path_loss_hold_the_truth_as_often_as_they_say(amplitude, low):
    """Also where neighbouring places say the same: an interval that takes them for independent would miss half."""
    hits = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        anchors, points = world(rng), places(rng, 50)
        y = strengths(anchors, points) + field(rng, points, amplitude, 3.0) + rng.normal(0.0, 3.0, (50, NODES))
        loss, _, _ = fit_path_loss(surveyed(anchors, points, y))
        hits.append([covered(loss.p1_dbm, anchors.p1_dbm), covered(loss.n, anchors.n)])
    assert low <= np.mean(hits) <= 0.995


def test_intervals_are_no_wider_than_they_need_to_be():
    rng = np.random.default_rng(1)
    anchors, points = world(rng), places(rng, 80)
    loss, _, _ = fit_path_loss(surveyed(anchors, points, strengths(anchors, points) + rng.normal(0, 3, (80, NODES))))
    H = np.stack([np.ones((80, NODES)), -10 * np.log10(np.linalg.norm(points[:, None] - anchors.positions, axis=-1))])
    ideal = [3.0 * np.sqrt(np.linalg.inv(H[:, :, k] @ H[:, :, k].T)[0, 0]) for k in range(NODES)]
    assert np.all(loss.p1_dbm.std < 1.6 * np.array(ideal))


def test_scatter_comes_back():
    rng = np.random.default_rng(2)
    anchors, points = world(rng), places(rng, 100)
    y = strengths(anchors, points) + rng.normal(0.0, 4.0, (100, NODES))
    sigma = fit_path_loss(surveyed(anchors, points, y))[0].sigma_db
    np.testing.assert_allclose(sigma.value, 4.0, rtol=0.15)
    assert np.mean(covered(sigma, 4.0)) > 0.8


def test_a_tenth_of_outliers_moves_little():
    rng = np.random.default_rng(3)
    anchors, points = world(rng), places(rng, 60)
    y = strengths(anchors, points) + rng.normal(0.0, 2.0, (60, NODES))
    clean, clean_map, _ = fit_path_loss(surveyed(anchors, points, y))
    spoiled = y.copy()
    for k in range(NODES):
        spoiled[rng.permutation(60)[:6], k] -= 35.0
    loss, radio_map, _ = fit_path_loss(surveyed(anchors, points, spoiled))
    assert np.all(np.abs(loss.p1_dbm.value - clean.p1_dbm.value) < 2.0)
    assert np.all(np.abs(loss.n.value - clean.n.value) < 0.3)
    assert np.all(covered(loss.p1_dbm, anchors.p1_dbm))
    told = np.where(spoiled < y, radio_map.noise_db, np.nan)
    assert np.nanmin(told) > 2.0 * np.nanmedian(np.where(spoiled < y, np.nan, radio_map.noise_db))
    assert radio_map.amplitude_db < clean_map.amplitude_db + 2.0


def test_the_field_comes_back():
    found = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        anchors, points = world(rng), places(rng, 80)
        y = strengths(anchors, points) + field(rng, points, 4.0, 3.0) + rng.normal(0.0, 1.5, (80, NODES))
        radio_map = fit_path_loss(surveyed(anchors, points, y))[1]
        found.append([radio_map.amplitude_db, radio_map.length, radio_map.place_db[0]])
    np.testing.assert_allclose(np.mean(found, axis=0), [4.0, 3.0, 1.5], rtol=0.25)


def test_a_map_predicts_places_that_it_has_not_seen():
    rng = np.random.default_rng(8)
    anchors, points = world(rng), places(rng, 120)
    truth = strengths(anchors, points) + field(rng, points, 4.0, 3.0)
    y = truth + rng.normal(0.0, 1.5, truth.shape)
    loss, radio_map, _ = fit_path_loss(surveyed(anchors, points[:90], y[:90]))
    error = mapped_rssi_function(anchors, radio_map, 1.0)(points[90:]) - truth[90:]
    by_line = strengths(anchors._replace(p1_dbm=loss.p1_dbm.value, n=loss.n.value), points[90:]) - truth[90:]
    assert np.sqrt(np.mean(error**2)) < 0.6 * np.sqrt(np.mean(by_line**2))
    assert 0.8 < np.std(error / residual_std(radio_map, points[90:])) < 1.25


def test_left_out_readings_err_as_they_should():
    rng = np.random.default_rng(9)
    anchors, points = world(rng), places(rng, 80)
    y = strengths(anchors, points) + field(rng, points, 3.0, 3.0) + rng.normal(0.0, 2.0, (80, NODES))
    survey = surveyed(anchors, points, y)
    H = np.stack([np.ones(y.shape), -10.0 * np.log10(survey.distances)], axis=-1)
    fit = fit_field(H, survey, PATH_LOSS)
    assert 0.9 < np.std(fit.left_out / fit.left_out_std) < 1.1
    alone = fit_field(H, survey, PATH_LOSS, field=False)
    assert np.nanmean(fit.left_out**2) < np.nanmean(alone.left_out**2)
