"""Those who look on at system B: reports of its nodes, markers of links, components and arrivals, viewers' files."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from visualization_msgs.msg import Marker, MarkerArray
from wsn_tracking_msgs import msg

import live
import viewers
from observer import observing
from wsn_tracking import graphs
from wsn_tracking.errors import TrackingError
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.nodes import convert_consensus, markers, qos
from wsn_tracking.trackers.consensus_report import ConsensusReport, Outcome, report_of
from wsn_tracking.viewing.node_states import ARRIVED, LOOKS, LOST, UNREPORTED, rgb
from wsn_tracking.viewing.scene import Scene

TIMEOUT = 60.0  # [s]
NODES = set(range(1, 11))
STAMP = 1_500_000_000_123_456_789
PLACES = {1: (0.0, 0.0), 2: (10.0, 0.0), 3: (50.0, 0.0), 4: (60.0, 0.0), 5: (70.0, 5.0), 9: (90.0, 0.0)}
WEST = [Outcome(1, 0.99, 0.1, (1, 2), (2,)), Outcome(2, 0.02, 0.2, (1, 2), (1,))]
EAST = [
    Outcome(5, 0.5, float('nan'), (3, 4, 5), (4,)),
    Outcome(3, 0.9, 0.0, (3, 4, 5), (4,)),
    Outcome(4, 0.9, 0.0, (3, 4, 5), (3, 5)),
]


@pytest.fixture
def scene():
    """A network that has fallen apart, its nodes in two processes; node 9 is dead."""
    held = Scene(10)
    held.add_anchors(make_anchors(list(PLACES), list(PLACES.values())))
    for outcomes in (WEST, EAST):
        held.add_consensus(report_of(STAMP, 1, 7, outcomes))
    return held


def drawn(scene):
    return {marker.ns: marker for marker in markers.scene_markers(scene, {}, 1.0, 0.0).markers}


def places(marker):
    return [(p.x, p.y) for p in marker.points]


def colors(marker):
    return [tuple(np.round([c.r, c.g, c.b], 6)) for c in marker.colors]


# ---- reports


def test_a_report_holds_every_node_and_every_link_once():
    report = report_of(STAMP, 1, 7, EAST)
    assert report[:4] == (STAMP, 1, 7, (3, 4, 5))
    assert (report.live, report.components) == ((3, 3, 3), (3, 3, 3))
    assert list(zip(report.link_senders, report.link_receivers, strict=True)) == [(4, 3), (3, 4), (5, 4), (4, 5)]


def test_a_report_survives_the_wire():
    report = report_of(STAMP, 65535, 2**32 - 1, WEST)
    sent = serialize_message(convert_consensus.report_message(report))
    assert convert_consensus.report_value(deserialize_message(sent, msg.ConsensusReport)) == report


@pytest.mark.parametrize('cut', ['node_ids', 'components', 'link_senders'])
def test_a_report_with_an_array_too_short_is_refused(cut):
    message = convert_consensus.report_message(report_of(STAMP, 1, 7, WEST))
    setattr(message, cut, getattr(message, cut)[:-1])
    with pytest.raises(TrackingError, match='expected the same length'):
        convert_consensus.report_value(message)


# ---- what is drawn of them


def test_links_are_drawn_once_between_their_nodes_in_the_colour_of_their_component(scene):
    line = drawn(scene)['links']
    assert line.type == Marker.LINE_LIST
    ends = [tuple(places(line)[at : at + 2]) for at in range(0, len(line.points), 2)]
    assert ends == [(PLACES[i], PLACES[j]) for i, j in ((1, 2), (3, 4), (4, 5))]
    assert len(line.colors) == len(line.points)
    west, *east = colors(line)[::2]
    assert set(east) == {tuple(np.round(rgb(markers.WHOLE), 6))}
    assert west not in east


def test_every_living_node_has_a_disc_of_its_component_and_a_dead_one_none(scene):
    disc = drawn(scene)['components']
    assert dict(zip(places(disc), colors(disc), strict=True)).keys() == {PLACES[i] for i in (1, 2, 3, 4, 5)}
    assert [colors(disc).count(color) for color in dict.fromkeys(colors(disc))] == [3, 2]


def test_nodes_are_coloured_by_whether_their_observation_arrived(scene):
    nodes = drawn(scene)['nodes']
    looks = {1: ARRIVED, 2: LOST, 3: ARRIVED, 4: ARRIVED, 5: ARRIVED}
    expected = [LOOKS[looks[i]] if i in looks else UNREPORTED for i in PLACES]
    np.testing.assert_allclose(
        [(c.r, c.g, c.b) for c in nodes.colors], [rgb(look.color) for look in expected], atol=1e-6
    )


def test_halves_that_have_met_are_one_component(scene):
    whole = (1, 2, 3, 4, 5)
    for outcomes in (WEST, EAST):
        scene.add_consensus(report_of(STAMP, 1, 8, [o._replace(live=whole) for o in outcomes]))
    assert [links.components for links in scene.links] == [(whole,)]
    assert set(colors(drawn(scene)['components'])) == {tuple(np.round(rgb(markers.WHOLE), 6))}


def test_who_told_nothing_for_two_epochs_leaves_the_network(scene):
    for seq in (8, 9):
        scene.add_consensus(report_of(STAMP, 1, seq, WEST))
    assert scene.links[0].components == ((1, 2),)
    assert set(scene.node_states) == {1, 2}
    scene.add_consensus(report_of(STAMP - 10**12, 1, 0, EAST))  # a new run
    assert scene.links[0].components == ((3, 4, 5),)


def test_nodes_without_a_place_and_reports_before_the_anchors_are_not_drawn():
    scene = Scene(10)
    scene.add_consensus(report_of(STAMP, 1, 7, EAST))
    assert not drawn(scene)
    scene.add_anchors(make_anchors([3, 5], [PLACES[3], PLACES[5]]))
    shown = drawn(scene)
    assert shown['links'].action == Marker.DELETE  # no link has both ends
    assert places(shown['components']) == [PLACES[3], PLACES[5]]


# ---- a running graph, and the viewers' files


@pytest.fixture(scope='module')
def seen():
    """Ten nodes in a field that is cut in the middle, drawn while they run."""
    told = [f'nodes={len(NODES)}', 'width=150.0', 'depth=180.0', 'epochs=600', 'faults=clutter']
    cut = {'link.cut_at': 75.0, 'link.cut_from': 5, 'link.cut_until': 100000, 'output_timeout': TIMEOUT}
    graph = graphs.simulation('b_field', 3, rate=10.0, scenario_settings=told, settings=cut, markers=True)
    with live.private_domain() as environment, observing(environment) as observer, live.started(graph, environment):
        arrays = observer.collect(MarkerArray, 'markers', qos.DISPLAY)
        reports = observer.collect(msg.ConsensusReport, 'consensus_report', qos.MEASUREMENTS)
        fixed = observer.collect(MarkerArray, 'anchor_markers', qos.LATCHED_LAST)
        observer.until(
            lambda: any(parted(array) for array in arrays) and len({m.components[0] for m in reports[-4:]}) > 1,
            TIMEOUT,
            'two components, drawn',
        )
        # reports are for whoever listens: of each process from when it is matched with this listener
        observer.until(lambda: {i for m in reports for i in m.node_ids} >= NODES, TIMEOUT, 'reports of every process')
        topics = viewers.offered(observer.node)
    return SimpleNamespace(arrays=arrays, reports=reports, anchors=fixed[-1], topics=topics)


def parted(array):
    """Whether links of two components and a node whose observation is lost are drawn, and a whole track."""
    named = {marker.ns: marker for marker in array.markers}
    lost = tuple(np.round(rgb(LOOKS[LOST].color), 6))
    return (
        {'links', 'components', 'nodes', 'truth', 'consensus_1/ellipse'} <= named.keys()
        and len(set(colors(named['links']))) > 1
        and lost in colors(named['nodes'])
        and len(named['consensus_1'].points) > 1
    )


def test_every_process_reports_its_nodes(seen):
    values = [convert_consensus.report_value(message) for message in seen.reports]
    assert all(isinstance(value, ConsensusReport) for value in values)
    assert {i for value in values for i in value.node_ids} == NODES
    assert all(0.0 <= p <= 1.0 for value in values for p in value.arrival_probabilities)


def test_a_process_that_has_begun_to_report_leaves_out_no_epoch(seen):
    values = [convert_consensus.report_value(message) for message in seen.reports]
    for ids in {value.node_ids for value in values}:
        epochs = [value.request_seq for value in values if value.node_ids == ids]
        assert epochs == list(range(epochs[0], epochs[0] + len(epochs)))


def test_rviz_topics_and_namespaces_are_those_of_the_graph(seen):
    path = viewers.RVIZ / 'consensus.rviz'
    viewers.check_rviz_topics(path, seen.topics)
    moving = {marker.ns for array in seen.arrays for marker in array.markers}
    fixed = {marker.ns for marker in seen.anchors.markers if marker.ns}
    viewers.check_namespaces(path, viewers.FOXGLOVE / 'consensus.json', fixed, moving)
    viewers.check_foxglove_paths(viewers.FOXGLOVE / 'consensus.json', seen.topics)
