"""Particles keep to a floor plan: rooms, yards, walls and corners."""

from dataclasses import replace

import numpy as np
import pytest
from human_cases import ANCHORS, EPOCHS, FEW, bounded, run

from wsn_tracking.errors import TrackingError
from wsn_tracking.models.body_likelihood import Readings
from wsn_tracking.models.walk import X
from wsn_tracking.trackers.human import HumanTracker
from wsn_tracking.trackers.human_config import MotionConfig
from wsn_tracking.trackers.human_models import curves_of

WITH_A_YARD = """x,y
0,0
100,0
100,100
0,100

40,40
60,40
60,60
40,60
"""


def test_a_floor_plan_is_kept_to_from_the_first_particle_on(tmp_path):
    """A house of 100 x 100 m round a yard, inside an area of half its width."""
    plan = tmp_path / 'layout.csv'
    plan.write_text(WITH_A_YARD)
    config = replace(FEW, area=(0.0, 0.0, 50.0, 200.0), floor_plan=str(plan))
    tracker = HumanTracker(config, ANCHORS)
    assert tracker._filter.area == (0.0, 0.0, 50.0, 100.0)
    for epoch in [None, *EPOCHS]:
        if epoch is not None:
            bounded(tracker.step(epoch))
        x, y = tracker.particles.positions.T
        assert (x <= 50.0).all()
        assert not ((x > 40.0) & (y > 40.0) & (y < 60.0)).any()


@pytest.mark.parametrize('kind', ['walk', 'random_walk', 'disc'])
def test_nobody_walks_through_a_wall(tmp_path, kind):
    """Two rooms with a wall of 10 cm between them: who is in one stays there, however long nothing is heard."""
    plan = tmp_path / 'rooms.csv'
    plan.write_text('0,0\n4.9,0\n4.9,10\n0,10\n\n5,0\n10,0\n10,10\n5,10\n')
    config = replace(FEW, area=(), floor_plan=str(plan), motion=MotionConfig(kind=kind), particles=400)
    human = HumanTracker(config, ANCHORS)._filter
    rng = np.random.default_rng(1)
    track = human.begin((), rng)
    left = track.cloud.s[X] < 4.95
    assert 100 < left.sum() < 300
    silent = Readings(np.full(16, np.nan), np.full(16, 3.0), curves_of(config, ANCHORS))
    for dt in (0.5, 0.5, 3.0, 30.0):
        track = human.step(track, dt, silent, rng).track
        assert track.parents is None
        np.testing.assert_array_equal(track.cloud.s[X] < 4.95, left)


def test_a_corner_polygon_is_an_area_too():
    tracker = HumanTracker(replace(FEW, area=(0.0, 0.0, 100.0, 0.0, 0.0, 100.0)), ANCHORS)
    run(tracker)
    assert (tracker.particles.positions.sum(axis=-1) <= 100.0 + 1e-9).all()


def test_a_plan_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(TrackingError, match=r'no\.csv cannot be read'):
        HumanTracker(replace(FEW, floor_plan=str(tmp_path / 'no.csv')), ANCHORS)


def test_a_floor_plan_of_another_frame_than_the_area_is_refused(tmp_path):
    plan = tmp_path / 'plan.csv'
    plan.write_text('500,500\n510,500\n510,510\n')
    with pytest.raises(TrackingError, match=r'`area` .* and the floor plan, .* have nothing in common'):
        HumanTracker(replace(FEW, area=(0.0, 0.0, 50.0, 200.0), floor_plan=str(plan)), ANCHORS)
