"""The first belief: a likelihood over a grid, which is to know how wrong it is."""

import numpy as np
import pytest
from oracles import LOOP, NOISE, H

from wsn_tracking.evaluation.metrics import nees
from wsn_tracking.filters.start import Sight, area_of, likelihood_start
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.measurement import constant_noise, range_function

AREA = LOOP.area
UNHEARD = np.full(12, np.nan)


def sights_of(rng, x, v=(0.0, 0.0), epochs=4, silent=0.0):
    """What the last epochs told of a target that is at x now."""
    ages = np.arange(epochs)[::-1].astype(float)
    out = []
    for age in ages:
        z = H(x - np.asarray(v) * age) * (1.0 + 0.12 * rng.standard_normal(12))
        out.append(Sight(age, np.where(rng.random(12) < silent, np.nan, z), H, NOISE))
    return out


def nees_of_starts(seed, starts, speed_std, moving=0.0, **options):
    rng, values, away = np.random.default_rng(seed), [], []
    for _ in range(starts):
        x = rng.uniform([0.3, 0.3], [3.3, 2.1])
        belief = likelihood_start(sights_of(rng, x, moving * rng.standard_normal(2), **options), AREA, speed_std)
        values.append(nees(belief.m[:2] - x, belief.P[:2, :2]))
        away.append(np.hypot(*(belief.m[:2] - x)))
    return np.array(values), np.array(away)


@pytest.mark.parametrize('silent', [0.0, 0.6])
def test_a_target_at_rest_is_found_within_the_told_covariance(silent):
    values, away = nees_of_starts(1, 100, 0.01, silent=silent)
    # a mean of 100 chi-squares of 2 has the standard deviation 0.2; the cell's share makes it a little cautious
    assert 1.2 < values.mean() < 2.5
    assert (values < 5.99).mean() > 0.9
    assert np.median(away) < 0.1


def test_a_walking_target_is_found_nearly_within_the_told_covariance():
    """All nodes are off by the same way: blurring each measurement for itself gives a mean NEES of 6 and more."""
    values, _ = nees_of_starts(2, 100, 0.1, moving=0.1)
    assert values.mean() < 3.5
    assert (values < 5.99).mean() > 0.8


def test_more_epochs_tell_more_of_a_target_at_rest():
    rng = np.random.default_rng(3)
    sights = sights_of(rng, np.array([1.1, 0.7]), epochs=8)
    traces = [np.trace(likelihood_start(sights[-n:], AREA, 0.01).P[:2, :2]) for n in (1, 2, 4, 8)]
    assert traces == sorted(traces, reverse=True)


def test_the_older_a_sight_the_less_it_tells():
    sight = sights_of(np.random.default_rng(4), np.array([2.0, 1.0]), epochs=1)[0]
    traces = [
        np.trace(likelihood_start([sight._replace(age=age)], AREA, 0.1).P[:2, :2]) for age in (0.0, 1.0, 3.0, 10.0)
    ]
    assert traces == sorted(traces)
    assert traces[-1] > 10.0 * traces[0]


def test_without_any_measurement_the_belief_is_the_flat_prior_itself():
    """Anything narrower would be a guess that nobody has heard."""
    belief = likelihood_start([Sight(0.0, UNHEARD, H, NOISE)], AREA, 0.1)
    np.testing.assert_allclose(belief.P[:2, :2], np.diag([3.6**2, 2.4**2]) / 12.0, rtol=0.02, atol=1e-9)
    np.testing.assert_allclose(belief.m, [1.8, 1.2, 0.0, 0.0], atol=0.05)


def test_the_start_follows_the_measurements_not_the_field():
    """The same sights, seen in a wider area: truth, centre and border have no say."""
    sights = sights_of(np.random.default_rng(5), np.array([0.9, 1.7]))
    narrow = likelihood_start(sights, AREA, 0.06, cells=20000)
    wide = likelihood_start(sights, (-2.0, -1.0, 6.0, 9.0), 0.06, cells=200000)
    np.testing.assert_allclose(wide.m[:2], narrow.m[:2], atol=0.01)
    np.testing.assert_allclose(wide.P[:2, :2], narrow.P[:2, :2], rtol=0.1, atol=1e-4)


def test_the_grid_posterior_is_the_kalman_posterior_where_that_is_exact():
    """Two far nodes whose ranges are all but linear: x and y measured with 0.2 m and 0.3 m."""
    anchors = make_anchors([1, 2], [[-1e5, 0.5], [0.5, -1e5]])
    h = range_function(anchors)
    z = h(np.array([[0.55, 0.45]]))[0]
    noise = constant_noise(np.array([0.2, 0.3]))
    belief = likelihood_start([Sight(0.0, z, h, noise)], (-2.0, -2.0, 3.0, 3.0), 0.5, cells=40000)
    np.testing.assert_allclose(belief.m, [0.55, 0.45, 0.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(belief.P, np.diag([0.04, 0.09, 0.25, 0.25]), atol=1e-3)
    aged = likelihood_start([Sight(0.6, z, h, noise)], (-3.0, -3.0, 4.0, 4.0), 0.5, cells=40000)
    np.testing.assert_allclose(aged.P[:2, :2], np.diag([0.04 + 0.09, 0.09 + 0.09]), atol=2e-3)


def test_sights_that_contradict_each_other_still_give_a_belief():
    first = Sight(1.0, H(np.array([[0.1, 0.1]]))[0], H, constant_noise(np.full(12, 1e-3)))
    second = Sight(0.0, H(np.array([[3.5, 2.3]]))[0], H, constant_noise(np.full(12, 1e-3)))
    belief = likelihood_start([first, second], AREA, 1e-3)
    assert np.all(np.isfinite(belief.m))
    assert np.all(np.diagonal(belief.chol_P) > 0.0)


def test_the_area_round_the_nodes_has_room_beside_them():
    np.testing.assert_allclose(area_of(LOOP.anchors), (-1.0, -1.0, 4.6, 3.4))
    far = make_anchors([1, 2], [[0.0, 0.0], [40.0, 10.0]])
    np.testing.assert_allclose(area_of(far), (-10.0, -10.0, 50.0, 20.0))


@pytest.mark.parametrize('ids', [[1], [1, 2, 3]])
def test_nodes_at_one_place_leave_as_much_room_as_a_radio_reaches(ids):
    x_min, y_min, x_max, y_max = area_of(make_anchors(ids, [[7.0, -2.0]] * len(ids)))
    assert (0.5 * (x_min + x_max), 0.5 * (y_min + y_max)) == (7.0, -2.0)
    assert min(x_max - x_min, y_max - y_min) >= 2 * 20.0  # a hall of 40 m, in the middle of which they hang


@pytest.mark.parametrize('area', [(-1.0, 0.5, 4.0, 0.5 + 1e-7), (0.5, -1.0, 0.5 + 1e-7, 4.0), (0.0, 0.0, 1e6, 1e-3)])
def test_an_area_without_width_is_a_line(area):
    """Its middle line: nothing is looked for beside it, and what is found lies on it."""
    start = likelihood_start([Sight(0.0, H(np.array([0.5, 0.5, 0.0, 0.0])), H, NOISE)], area, 0.1)
    assert np.all(np.isfinite(start.chol_P))
    assert area[0] <= start.m[0] <= area[2]
    assert area[1] <= start.m[1] <= area[3]
