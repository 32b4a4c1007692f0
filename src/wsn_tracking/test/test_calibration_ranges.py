"""Bias and scale of ranging radios lie in their intervals; a survey gathers readings by place."""

from __future__ import annotations

import numpy as np
import pytest
from survey_cases import NODES, SIDE, covered, world

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.channel_fit import fit_ranging
from wsn_tracking.sensing.survey import Readings, Survey, survey_of


def ranging(rng, until=200, outliers=0.0, nodes_heard=NODES):
    """Readings along a walk through the room, 0.05 m noise, some of them much too long."""
    anchors = world(rng)
    bias, scale = rng.normal(0.15, 0.05, NODES), rng.normal(1.02, 0.002, NODES)
    walk = np.column_stack([np.cumsum(rng.normal(0.0, 0.25, (until, 2)), axis=0) % SIDE, np.ones(until)])
    d = np.linalg.norm(walk[:, None] - anchors.positions, axis=-1)
    z = bias + scale * d + rng.normal(0.0, 0.05, d.shape)
    z = np.where(rng.random(d.shape) < outliers, z + rng.exponential(2.0, d.shape), z)
    rows = np.tile(np.arange(NODES), (until, 1))
    use = rows < nodes_heard
    positions = np.repeat(walk[:, None], NODES, axis=1)
    readings = Readings(positions[use], rows[use], z[use])
    return bias, scale, survey_of(readings, anchors, ranges=True)


@pytest.mark.parametrize(('outliers', 'low'), [(0.0, 0.92), (0.1, 0.85)])
def test_bias_and_scale_lie_in_their_intervals(outliers, low):
    hits, errors = [], []
    for seed in range(8):
        bias, scale, survey = ranging(np.random.default_rng(seed), outliers=outliers)
        found = fit_ranging(survey)
        hits.append([covered(found.bias, bias), covered(found.scale, scale)])
        errors.append(found.bias.value - bias)
    assert np.mean(hits) >= low
    assert np.sqrt(np.mean(np.square(errors))) < 0.05


def test_a_node_that_was_not_heard_gets_what_all_have_in_common():
    _, _, survey = ranging(np.random.default_rng(4), nodes_heard=NODES - 1)
    found = fit_ranging(survey)
    assert found.places[-1] == found.readings[-1] == 0
    assert found.bias.value[-1] == pytest.approx(np.mean(found.bias.value[:-1]), abs=0.03)
    assert found.bias.std[-1] > 2.0 * found.bias.std[:-1].max()


def test_one_place_alone_makes_up_no_scale():
    anchors = world(np.random.default_rng(5))
    at = np.tile([3.0, 4.0, 1.0], (40 * NODES, 1))
    rows = np.tile(np.arange(NODES), 40)
    d = np.linalg.norm(at - anchors.positions[rows], axis=1)
    noise = np.random.default_rng(6).normal(0.0, 0.05, d.size)
    found = fit_ranging(survey_of(Readings(at, rows, d + 0.2 + noise), anchors, ranges=True))
    assert np.all(np.abs(found.scale.value - 1.0) < 0.03)
    assert np.all(covered(found.scale, 1.0))
    here = found.bias.value[rows[:NODES]] + (found.scale.value - 1.0)[rows[:NODES]] * d[:NODES]
    np.testing.assert_allclose(here, 0.2, atol=0.06)


# ---- surveys


def test_readings_are_gathered_by_place():
    anchors = make_anchors([1, 2], [[0.0, 0.0, 3.0], [4.0, 0.0, 3.0]])
    positions = np.array([[1.0, 1.0, 1.0]] * 3 + [[3.1, 1.0, 1.0]])
    survey = survey_of(Readings(positions, np.array([1, 1, 2, 1]), np.array([-50.0, -52.0, -60.0, -70.0])), anchors)
    assert isinstance(survey, Survey)
    assert survey.values.shape == (2, 2)
    assert survey.values[0].tolist() == [-51.0, -60.0]
    assert survey.counts.tolist() == [[2.0, 1.0], [1.0, 0.0]]
    assert survey.distances[0, 0] == pytest.approx(np.sqrt(1.0 + 1.0 + 4.0))  # three-dimensional
    assert survey.scatter[0, 0] == pytest.approx(np.sqrt(2.0))
    assert np.isnan(survey.scatter[0, 1])
    assert not survey.known[1, 1]


def test_the_way_through_a_place_is_no_scatter():
    anchors = make_anchors([1], [[0.0, 0.0]])
    x = np.linspace(0.3, 4.0, 400)
    positions = np.column_stack([x, np.zeros(400), np.zeros(400)])
    y = -50.0 - 30.0 * np.log10(x)
    survey = survey_of(Readings(positions, np.ones(400, dtype=np.int64), y), anchors)
    assert np.nanmax(survey.scatter) < 1e-6


def test_there_are_never_too_many_places():
    rng = np.random.default_rng(7)
    anchors = make_anchors([1], [[0.0, 0.0]])
    positions = np.column_stack([rng.uniform(0.0, 300.0, (5000, 2)), np.zeros(5000)])
    survey = survey_of(Readings(positions, np.ones(5000, dtype=np.int64), np.full(5000, -60.0)), anchors)
    assert 20 < len(survey.points) <= 150
    assert survey.counts.sum() == 5000
