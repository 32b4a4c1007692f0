"""What systems are told of a field that no configuration was made for."""

import numpy as np
import pytest
from graph_cases import a_loop
from hypothesis import given
from hypothesis import strategies as st

from wsn_tracking import offline
from wsn_tracking.configuration import load_configuration
from wsn_tracking.evaluation.interpolation import truth_at
from wsn_tracking.graphs import SYSTEMS, plans_of, source_of
from wsn_tracking.graphs.facts import connecting_radius, facts_of, told
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.models.graph import adjacency, is_connected

A_LOOP = a_loop(60)
NAMELESS = source_of('somewhere', A_LOOP)._replace(metadata={})
SPACING = 1.2  # [m] between the nodes of a_loop

places = st.lists(st.tuples(*[st.integers(-(10**6), 10**6)] * 3), min_size=2, max_size=12, unique=True)  # [mm]


@given(places)
def test_the_radius_connects_and_no_lesser_one_does(nodes):
    positions = 1e-3 * np.array(nodes)
    radius = connecting_radius(positions)
    assert is_connected(adjacency(positions, radius))
    assert not is_connected(adjacency(positions, radius * (1.0 - 1e-6)))


def test_a_node_alone_and_nodes_in_one_place_have_a_radius():
    for positions in (np.zeros((1, 3)), np.ones((4, 3))):
        assert connecting_radius(positions) == 1.0


@pytest.mark.parametrize('scale', [0.25, 10.0, 150.0])
def test_facts_grow_with_the_field(scale):
    anchors = A_LOOP.anchors
    larger = make_anchors(anchors.ids, scale * 10.0 * anchors.positions)
    small, large = (facts_of(NAMELESS, a) for a in (make_anchors(anchors.ids, 10.0 * anchors.positions), larger))
    assert large.speed == pytest.approx(scale * small.speed)
    assert large.spectral_density == pytest.approx(scale**2 * small.spectral_density)
    assert large.radius == pytest.approx(scale * small.radius)
    assert large.rounds == small.rounds


@pytest.mark.parametrize('system', SYSTEMS)
def test_what_is_told_are_parameters_and_settings_come_first(system):
    anchors = A_LOOP.anchors
    guessed = told(system, NAMELESS, anchors, facts_of(NAMELESS, anchors))
    assert guessed
    (plan,) = plans_of(NAMELESS, anchors, system)
    assert {name: plan.parameters[name] for name in guessed if name in plan.parameters} == {
        name: value for name, value in guessed.items() if name in plan.parameters
    }
    name, value = next((n, v) for n, v in guessed.items() if isinstance(v, float) and n in plan.parameters)
    (mine,) = plans_of(NAMELESS, anchors, system, settings={name: 0.5 * value})
    assert mine.parameters[name] == 0.5 * value


@pytest.mark.parametrize('system', SYSTEMS)
def test_a_configuration_that_is_asked_for_or_named_by_the_feed_counts_alone(system):
    named = NAMELESS._replace(metadata={'configuration': system})
    (own,), (asked,) = plans_of(named, A_LOOP.anchors, system), plans_of(NAMELESS, A_LOOP.anchors, system, system)
    (loaded,) = plans_of(NAMELESS, A_LOOP.anchors, system, load_configuration(system))
    assert own.parameters == asked.parameters == loaded.parameters
    assert own.parameters != plans_of(NAMELESS, A_LOOP.anchors, system)[0].parameters


@pytest.mark.parametrize('system', SYSTEMS)
def test_every_system_follows_a_robot_in_a_field_that_it_was_not_set_up_for(system):
    """From 20 epochs on nearer than nodes are to each other, by a factor of four."""
    run = offline.offline(NAMELESS, A_LOOP, trackers=system)
    truth = A_LOOP.truth[1]
    for estimates in run.estimates.values():
        late = [e for e in estimates if e.request_seq >= estimates[0].request_seq + 20]
        there = truth_at(truth, np.array([e.stamp_ns for e in late])).positions[:, :2]
        away = np.hypot(*(np.array([e.mean[:2] for e in late]) - there).T)
        assert np.sqrt(np.mean(away**2)) < SPACING / 4
