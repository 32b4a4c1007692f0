"""Trends, field and shrinkage: known parameters come back, within their intervals, as often as stated."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.matern import matern
from wsn_tracking.sensing.channel_fit import PATH_LOSS, fit_path_loss, fit_ranging
from wsn_tracking.sensing.field import Data, Hyper, cost, covariance, left_out
from wsn_tracking.sensing.field_fit import fit_field
from wsn_tracking.sensing.shrinkage import PopulationPrior, shrink
from wsn_tracking.sensing.survey import Readings, Survey, survey_of, survey_of_places

NODES, SIDE = 6, 10.0


def world(rng, p1_spread=2.0, n_spread=0.2):
    """Nodes along the walls of a room, with radios of one make."""
    positions = np.column_stack([rng.uniform(0.0, SIDE, (NODES, 2)), np.full(NODES, 2.0)])
    positions[np.arange(NODES), np.arange(NODES) % 2] = np.where(np.arange(NODES) < NODES // 2, 0.0, SIDE)
    p1, n = rng.normal(-55.0, p1_spread, NODES), rng.normal(2.2, n_spread, NODES)
    return make_anchors(range(NODES), positions, p1_dbm=p1, n=n, sigma_db=4.0)


def places(rng, count):
    return np.column_stack([rng.uniform(0.0, SIDE, (count, 2)), np.ones(count)])


def strengths(anchors, points):
    d = np.linalg.norm(points[:, None] - anchors.positions, axis=-1)
    return anchors.p1_dbm - 10.0 * anchors.n * np.log10(d)


def surveyed(anchors, points, values, counts=1.0):
    shape = values.shape
    return survey_of_places(anchors, points, values, np.full(shape, np.nan), np.full(shape, counts))


def field(rng, points, amplitude, length):
    R = matern(points, points[:, :2], length) + 1e-9 * np.eye(len(points))
    return amplitude * np.linalg.cholesky(R) @ rng.standard_normal((len(points), NODES))


def covered(quantity, truth):
    return (quantity.low <= truth) & (truth <= quantity.high)


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
    from wsn_tracking.models.measurement import mapped_rssi_function
    from wsn_tracking.models.radio_map import residual_std

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


def example(seed=0, count=12):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 5.0, (count, 2))
    H = np.stack([np.ones((count, 2)), rng.normal(0.0, 2.0, (count, 2))], axis=-1)
    known = rng.random((count, 2)) > 0.2
    y = np.where(known, rng.normal(-60.0, 5.0, (count, 2)), 0.0)
    H = np.where(known[..., None], H, 0.0)
    trust = rng.uniform(0.3, 1.0, y.shape)
    data = Data(points, H, y, known, rng.integers(1, 9, y.shape) * 1.0, np.array([1.0, 2.0]), trust)
    return Hyper(3.0, 1.5, 0.7), data, np.array([-58.0, 1.0]), np.array([[4.0, 0.3], [0.3, 0.5]])


def dense(hyper, data, mean, spread, k):
    """Mean and covariance of node k's readings, written out."""
    there = np.flatnonzero(data.known[:, k])
    H = data.H[there, k]
    C = np.empty((there.size, there.size))
    for i, a in enumerate(there):
        for j, b in enumerate(there):
            r = np.sqrt(3.0) * np.linalg.norm(data.points[a] - data.points[b]) / hyper.length
            C[i, j] = hyper.amplitude**2 * (1.0 + r) * np.exp(-r) + H[i] @ spread @ H[j]
        C[i, i] += (hyper.place**2 + data.packet[k] ** 2 / data.counts[a, k]) / data.trust[a, k]
    return data.y[there, k], H @ mean, C


def test_the_marginal_likelihood_is_that_of_a_dense_normal():
    hyper, data, mean, spread = example()
    other = hyper._replace(length=3.0, place=1.4)

    def oracle(h):
        parts = [dense(h, data, mean, spread, k) for k in range(2)]
        return -sum(multivariate_normal(m, C).logpdf(y) for y, m, C in parts)

    ours = cost(other, data, mean, spread) - cost(hyper, data, mean, spread)
    assert ours == pytest.approx(oracle(other) - oracle(hyper), rel=1e-9)


def test_left_out_is_what_leaving_out_gives():
    hyper, data, mean, spread = example(1)
    error, std = left_out(hyper, data, mean, spread)
    for k in range(2):
        y, m, C = dense(hyper, data, mean, spread, k)
        for i, place in enumerate(np.flatnonzero(data.known[:, k])):
            rest = np.delete(np.arange(y.size), i)
            gain = C[i, rest] @ np.linalg.inv(C[np.ix_(rest, rest)])
            assert error[place, k] == pytest.approx(y[i] - m[i] - gain @ (y - m)[rest])
            assert std[place, k] == pytest.approx(np.sqrt(C[i, i] - gain @ C[rest, i]))
    assert np.array_equal(np.isnan(error), ~data.known)


def test_an_unknown_reading_stands_alone():
    hyper, data, _, _ = example(2)
    C = covariance(hyper, data)
    place, node = np.argwhere(~data.known)[0]
    row = np.delete(C[node, place], place)
    assert np.all(row == 0.0)
    assert C[node, place, place] == 1.0


# ---- shrinkage

PRIOR = PopulationPrior(np.array([0.0, 0.0]), np.array([100.0, 100.0]), np.array([1.0, 1.0]), 1.0)


def drawn(rng, nodes, mean, spread, counts):
    """Coefficients of a population, and what readings with unit noise tell of them."""
    beta = rng.multivariate_normal(mean, np.diag(np.square(spread)), nodes)
    A, b = np.zeros((nodes, 2, 2)), np.zeros((nodes, 2))
    for k, count in enumerate(counts):
        X = np.column_stack([np.ones(count), rng.uniform(-3.0, 3.0, count)])
        y = X @ beta[k] + rng.standard_normal(count)
        A[k], b[k] = X.T @ X, X.T @ y
    return beta, A, b


def test_much_data_speaks_for_itself_and_none_for_the_population():
    rng = np.random.default_rng(0)
    counts = [3000] * 9 + [0]
    _, A, b = drawn(rng, 10, [5.0, -2.0], [2.0, 0.5], counts)
    found = shrink(A, b, PRIOR)
    own = np.linalg.solve(A[:9], b[:9, :, None])[..., 0]
    np.testing.assert_allclose(found.beta[:9], own, atol=0.01)
    np.testing.assert_allclose(found.beta[9], found.mean, atol=1e-9)
    np.testing.assert_allclose(found.cov[9], found.spread + found.mean_cov, rtol=1e-6)


def test_little_data_lies_between_itself_and_the_population():
    rng = np.random.default_rng(1)
    _, A, b = drawn(rng, 12, [5.0, -2.0], [1.0, 0.3], [200] * 11 + [3])
    found = shrink(A, b, PRIOR)
    own = np.linalg.solve(A[11], b[11])
    T, V = np.linalg.inv(found.spread), np.linalg.inv(A[11] + np.linalg.inv(found.spread))
    np.testing.assert_allclose(found.beta[11], V @ (A[11] @ own + T @ found.mean), rtol=1e-6)
    assert np.all(np.linalg.eigvalsh(np.linalg.inv(A[11]) - V) > 0.0)


def test_shrinking_helps_those_of_whom_little_is_known():
    gains = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        beta, A, b = drawn(rng, 12, [5.0, -2.0], [0.7, 0.2], [4] * 12)
        found = shrink(A, b, PRIOR)
        own = np.linalg.solve(A, b[..., None])[..., 0]
        gains.append([np.sum((found.beta - beta) ** 2), np.sum((own - beta) ** 2)])
    ours, theirs = np.sum(gains, axis=0)
    assert ours < 0.75 * theirs


def test_intervals_of_shrunk_nodes_hold_the_truth():
    hits = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        beta, A, b = drawn(rng, 12, [5.0, -2.0], [1.0, 0.3], [3, 4, 5, 6, 8, 10, 12, 15, 20, 30, 50, 0])
        found = shrink(A, b, PRIOR)
        half = 1.96 * np.sqrt(np.diagonal(found.cov, axis1=1, axis2=2))
        hits.append(np.abs(found.beta - beta) < half)
    assert 0.92 < np.mean(hits) < 0.985


def test_the_order_of_nodes_is_indifferent():
    rng = np.random.default_rng(2)
    _, A, b = drawn(rng, 8, [1.0, 1.0], [1.0, 1.0], [5] * 8)
    order = rng.permutation(8)
    there, back = shrink(A, b, PRIOR), shrink(A[order], b[order], PRIOR)
    np.testing.assert_allclose(there.beta[order], back.beta, rtol=1e-9)


# ---- ranges


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
