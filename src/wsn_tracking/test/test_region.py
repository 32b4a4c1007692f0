"""Regions: rectangles, floors with corners, holes and walls; against shapes whose inside is known otherwise."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking.errors import TrackingError
from wsn_tracking.filters.belief import Belief
from wsn_tracking.filters.start import Sight, likelihood_start
from wsn_tracking.models.region import MAX_PAIRS, kept_inside, region, region_of
from wsn_tracking.sensing.floor_plan import read_floor_plan
from wsn_tracking.trackers.random_q import RandomQConfig, keep_inside

L = (0.0, 0.0, 4.0, 0.0, 4.0, 1.0, 1.0, 1.0, 1.0, 3.0, 0.0, 3.0)  # [0, 4] x [0, 1] and [0, 1] x [0, 3]
SQUARE = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]
HOLE = [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)]
POINTS = np.random.default_rng(1).uniform(-1.0, 5.0, (4000, 2))


def in_box(p, x0, y0, x1, y1):
    return (p[..., 0] > x0) & (p[..., 0] < x1) & (p[..., 1] > y0) & (p[..., 1] < y1)


def in_l(p):
    return in_box(p, 0, 0, 4, 1) | in_box(p, 0, 0, 1, 3)


def test_inside_is_what_the_shapes_say():
    np.testing.assert_array_equal(region_of(L).contains(POINTS), in_l(POINTS))
    np.testing.assert_array_equal(region_of((0.0, 1.0, 2.0, 4.0)).contains(POINTS), in_box(POINTS, 0, 1, 2, 4))
    holed = region([SQUARE, HOLE])
    np.testing.assert_array_equal(holed.contains(POINTS), in_box(POINTS, 0, 0, 3, 3) & ~in_box(POINTS, 1, 1, 2, 2))
    assert not holed.contains([np.nan, 1.0])
    assert region_of(L).box == (0.0, 0.0, 4.0, 3.0)


@given(st.integers(0, 5), st.integers(3, 9), st.integers(0, 2**31))
def test_inside_does_not_depend_on_where_a_ring_begins_or_how_it_turns(shift, corners, seed):
    rng = np.random.default_rng(seed)
    ring = np.column_stack([f(np.sort(rng.uniform(0.0, 6.0, corners))) for f in (np.cos, np.sin)])
    if abs(np.linalg.det(ring[:2])) < 1e-6:
        return
    points = rng.uniform(-1.2, 1.2, (50, 2))
    one = region([ring]).contains(points)
    np.testing.assert_array_equal(one, region([np.roll(ring, shift, axis=0)[::-1]]).contains(points))
    np.testing.assert_array_equal(one, region([np.concatenate([ring, ring[:1]])]).contains(points))


@pytest.mark.parametrize('floor', [region_of(L), region([SQUARE, HOLE])])
def test_the_nearest_is_inside_and_none_of_the_inside_is_nearer(floor):
    brought = floor.nearest(POINTS.reshape(40, 100, 2)).reshape(-1, 2)
    inside = floor.contains(POINTS)
    np.testing.assert_array_equal(brought[inside], POINTS[inside])
    assert floor.contains(brought).all()
    way = np.hypot(*(brought - POINTS).T)
    for p, far in list(zip(POINTS, way, strict=True))[:300]:
        assert far <= np.hypot(*(POINTS[inside] - p).T).min() + 1e-5


@pytest.mark.filterwarnings('error')
def test_a_corner_that_is_told_twice_is_one():
    doubled = region([np.repeat(SQUARE, 2, axis=0), [*HOLE, HOLE[0]]])
    np.testing.assert_array_equal(doubled.nearest(POINTS), region([SQUARE, HOLE]).nearest(POINTS))


def test_a_floor_in_the_grid_of_a_country_is_the_same_floor():
    away = np.array([4.5e5, 5.4e6])
    there = region([away + SQUARE, away + HOLE])
    np.testing.assert_allclose(there.nearest(away + POINTS) - away, region([SQUARE, HOLE]).nearest(POINTS), atol=1e-8)


def test_points_that_are_no_numbers_stay_as_they_are():
    kept = region_of(L).nearest([[np.nan, 1.0], [9.0, np.inf], [9.0, 0.5]])
    np.testing.assert_array_equal(kept[:2], [[np.nan, 1.0], [9.0, np.inf]])
    np.testing.assert_allclose(kept[2], [4.0, 0.5], atol=1e-5)


def test_many_points_are_looked_at_in_blocks():
    many = np.tile(POINTS, (MAX_PAIRS // POINTS.shape[0] // 3, 1))
    np.testing.assert_array_equal(region_of(L).contains(many), in_l(many))
    assert region_of(L).contains(np.empty((0, 2))).shape == (0,)


def test_a_way_through_a_wall_is_told_from_one_through_a_door():
    floor = region_of(L)
    crossed = floor.crossed([[0.5, 2.0], [0.5, 2.0], [0.5, 2.5]], [[3.0, 0.5], [0.6, 0.5], [0.5, 5.0]])
    np.testing.assert_array_equal(crossed, [True, False, True])


@given(st.lists(st.floats(-10.0, 10.0), min_size=4, max_size=4))
def test_a_rectangle_clips(edges):
    x0, x1 = sorted(edges[:2])
    y0, y1 = sorted(edges[2:])
    if x1 - x0 < 1e-3 or y1 - y0 < 1e-3:
        return
    area = (x0, y0, x1, y1)
    np.testing.assert_array_equal(kept_inside(POINTS, area), np.clip(POINTS, area[:2], area[2:]))
    np.testing.assert_allclose(region_of(area).nearest(POINTS), kept_inside(POINTS, area), atol=1e-5)


def test_a_position_is_kept_inside_corners():
    belief = Belief(np.array([[3.0, 2.0, 0.1, 0.2], [0.5, 0.5, 0.0, 0.0]]), np.tile(np.eye(4), (2, 1, 1)))
    kept = keep_inside(belief, L)
    np.testing.assert_allclose(kept.m, [[3.0, 1.0, 0.1, 0.2], [0.5, 0.5, 0.0, 0.0]], atol=1e-5)
    assert kept.chol_P is belief.chol_P


def test_a_start_lies_within_corners():
    """A range of 2.5 m from a node at the inner corner's side is possible in both arms, and nowhere between."""

    def h(x):
        return np.hypot(x[..., 0], x[..., 1])[..., None]

    def noise(x):
        return np.full((*x.shape[:-1], 1), 0.05)

    sight = [Sight(0.0, np.array([2.5]), h, noise)]
    free = likelihood_start(sight, (0.0, 0.0, 4.0, 3.0), 0.1)
    held = likelihood_start(sight, L, 0.1)
    # the arms are 1 m wide: the part of the ring that is in them has its mean nearer to the corner at 0, 0
    ring = np.array([(2.5 * np.cos(a), 2.5 * np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 20001)])
    expected = ring[in_l(ring)]
    np.testing.assert_allclose(held.m[:2], expected.mean(axis=0), atol=0.05)
    assert np.linalg.norm(free.m[:2] - ring.mean(axis=0)) < 0.05
    np.testing.assert_allclose(held.P[:2, :2], np.cov(expected.T), atol=0.1)


@pytest.mark.parametrize(
    ('area', 'said'),
    [
        ((1.0, 2.0), 'expected x_min'),
        ((1.0, 0.0, 0.0, 1.0), 'min < max'),
        ((0.0, 0.0, 1.0, 1.0, 2.0, 2.0), 'no area'),
        ((0.0, 0.0, 1.0, 1.0, 2.0, float('nan')), 'finite'),
        ((0.0, 0.0, 1e308, 1e308), r'at most 1e\+08'),
        ((0.0,) * 7, 'three or more corners'),
    ],
)
def test_an_area_that_is_none_is_refused(area, said):
    with pytest.raises(TrackingError, match=said):
        dataclasses.replace(RandomQConfig(), area=area).checked()
    with pytest.raises(TrackingError, match='no ring'):
        region([])


def test_a_floor_plan_is_read(tmp_path):
    path = tmp_path / 'floor.csv'
    corners = '\n'.join(f'{x},{y}' for x, y in SQUARE)
    holes = '\n'.join(f'{x}, {y}  # inner' for x, y in HOLE)
    path.write_text(f'x,y\n# outline\n{corners}\n\n\n{holes}\n\n')
    np.testing.assert_array_equal(read_floor_plan(str(path)).contains(POINTS), region([SQUARE, HOLE]).contains(POINTS))


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('0,0\n1,x\n', r"line 2 is '1,x': expected a corner"),
        ('0,0\n1,1,2\n', 'line 2'),
        ('0,0\n1,1\n', 'ring 1 of a region has 2 corners'),
        ('', 'no ring'),
        ('0,0\n1,0\nnan,1\n', 'finite'),
    ],
)
def test_a_bad_floor_plan_is_refused(tmp_path, text, said):
    path = tmp_path / 'floor.csv'
    path.write_text(text)
    with pytest.raises(TrackingError, match=said):
        read_floor_plan(str(path))
    with pytest.raises(TrackingError, match='cannot be read'):
        read_floor_plan(str(tmp_path))
