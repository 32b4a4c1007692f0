"""Those who only look on: marker_node and `watch` beside one replay, and what the viewers' files name of it."""

from __future__ import annotations

import signal
from types import SimpleNamespace

import numpy as np
import pytest
from nav_msgs.msg import Path
from visualization_msgs.msg import Marker, MarkerArray
from wsn_tracking_msgs.msg import TargetEstimate, TriggerReport

import live
import viewers
from observer import observing
from watching import File, watching
from wsn_tracking import graphs
from wsn_tracking.bags.read import read
from wsn_tracking.evaluation.ellipses import CHI2_95
from wsn_tracking.nodes import convert, qos
from wsn_tracking.viewing.node_states import LOOKS, SENT, rgb

TIMEOUT = 120.0  # [s] far beyond what a start takes on a busy machine
RATE = 25.0
TRACK = 30  # epochs
RVIZ = viewers.RVIZ / 'random_q.rviz'
FOXGLOVE = viewers.FOXGLOVE / 'wsn_tracking.json'


@pytest.fixture(scope='module')
def seen(tmp_path_factory):
    """One replay with markers, watched."""
    png = File(tmp_path_factory.mktemp('watch') / 'live.png')
    graph = graphs.replay(str(live.A_LOOP), rate=RATE, settings={'track_length': TRACK}, markers=True)
    with (
        live.private_domain() as environment,
        observing(environment) as observer,
        watching(environment, '--png', str(png.path), '--every', '0.2') as watch,
        live.started([p for p in graph if p.name == 'markers'], environment) as first,
    ):
        arrays = observer.collect(MarkerArray, 'markers', qos.DISPLAY)
        estimates = observer.collect(TargetEstimate, 'estimate/fused_1', qos.ESTIMATES)
        reports = observer.collect(TriggerReport, 'trigger_report', qos.MEASUREMENTS)
        # nobody waits for an onlooker, so these two come first: with the observer, three take the reports
        observer.until(lambda: observer.node.count_subscribers('trigger_report') == 3, TIMEOUT, 'both onlookers')
        with live.started([p for p in graph if p.name != 'markers'], environment):
            observer.until(
                lambda: shows_full_track(arrays) and png.shows_all() and len(png.look()) >= 3,
                TIMEOUT,
                'a full track in markers, and a map that shows everything',
            )
            topics = viewers.offered(observer.node)
        late = observer.collect(MarkerArray, 'anchor_markers', qos.LATCHED_LAST)
        paths = {
            name: observer.collect(Path, f'path/{name}', qos.LATCHED_LAST) for name in ('fused_1', 'truth_target_1')
        }
        observer.until(lambda: late and all(paths.values()), TIMEOUT, 'anchors and paths, by who came late')
        onlookers = {'watch': watch, **first}
        for process in onlookers.values():
            process.send_signal(signal.SIGINT)
        outputs = {name: process.communicate(timeout=TIMEOUT)[0] for name, process in onlookers.items()}
        png.look()
    return SimpleNamespace(
        png=png,
        arrays=arrays,
        anchors=late[-1],
        paths=paths,
        estimates={stamp_ns(e): e for e in estimates},
        reports={stamp_ns(r): r for r in reports},
        topics=topics,
        codes={name: process.returncode for name, process in onlookers.items()},
        outputs=outputs,
    )


def shows_full_track(arrays):
    """Whether the latest array holds the longest track of fused_1 that there may be."""
    return bool(arrays) and any(m.ns == 'fused_1' and len(m.points) == TRACK for m in arrays[-1].markers)


def settled(seen):
    """Markers by namespace of the latest array that shows an estimate and a report that were seen, and these two."""
    for array in reversed(seen.arrays):
        named = {marker.ns: marker for marker in array.markers}
        if not {'fused_1', 'nodes'} <= set(named):
            continue
        estimate = seen.estimates.get(stamp_ns(named['fused_1']))
        report = seen.reports.get(stamp_ns(named['nodes']))
        if estimate is not None and report is not None:
            return named, estimate, report
    raise AssertionError('no array shows what was seen')


def stamp_ns(message):
    return convert.stamp_ns(message.header.stamp)


def planar(points):
    return np.array([(p.x, p.y) for p in points])


# ---- marker_node


def test_anchors_are_latched_with_their_ids(seen):
    table = read(live.A_LOOP).anchors
    assert seen.anchors.markers[0].action == Marker.DELETEALL
    (boxes,) = [m for m in seen.anchors.markers if m.ns == 'anchors']
    np.testing.assert_allclose([(p.x, p.y, p.z) for p in boxes.points], table.positions)
    texts = [m for m in seen.anchors.markers if m.ns == 'anchors/id']
    assert [m.text for m in texts] == [str(node) for node in table.ids]
    assert len({m.id for m in texts}) == len(texts)


def test_ellipse_of_an_estimate_is_its_95_percent_region(seen):
    named, estimate, _ = settled(seen)
    offset = planar(named['fused_1/ellipse'].points) - estimate.mean[:2]
    P = np.array(estimate.covariance).reshape(4, 4)[:2, :2]
    np.testing.assert_allclose(np.einsum('pi,ij,pj->p', offset, np.linalg.inv(P), offset), CHI2_95, rtol=1e-6)


def test_a_track_ends_at_the_estimate_and_is_bounded(seen):
    named, estimate, _ = settled(seen)
    line = named['fused_1']
    assert line.type == Marker.LINE_STRIP
    assert len(line.points) == TRACK
    np.testing.assert_allclose(planar(line.points)[-1], estimate.mean[:2])
    place = named['fused_1/position'].pose.position
    np.testing.assert_allclose((place.x, place.y), estimate.mean[:2])


def test_a_path_is_the_track_with_stamps(seen):
    """nav_msgs/Path, latched, for RViz as it comes and for tools that know no markers."""
    path, truth = seen.paths['fused_1'][-1], seen.paths['truth_target_1'][-1]
    assert path.header.frame_id == truth.header.frame_id == 'map'
    assert 2 <= len(path.poses) <= TRACK
    stamps = [stamp_ns(pose) for pose in path.poses]
    assert stamps == sorted(stamps)
    assert stamps[-1] == stamp_ns(path)
    for pose in path.poses:
        if stamp_ns(pose) in seen.estimates:
            assert [pose.pose.position.x, pose.pose.position.y] == list(seen.estimates[stamp_ns(pose)].mean[:2])
    assert len(truth.poses) >= 2


def test_nodes_are_coloured_by_what_they_did_in_the_epoch(seen):
    named, _, report = settled(seen)
    states = dict.fromkeys(report.sent_ids, SENT) | dict(zip(report.silent_ids, report.reasons, strict=True))
    looks = [rgb(LOOKS[states[node]].color) for node in read(live.A_LOOP).anchors.ids.tolist()]
    np.testing.assert_allclose([(c.r, c.g, c.b) for c in named['nodes'].colors], looks, atol=1e-6)
    assert len(set(looks)) > 1


def test_truth_is_drawn_where_the_target_is(seen):
    named, _, _ = settled(seen)
    truth = read(live.A_LOOP).truth[1]
    line = planar(named['truth'].points)
    distance = np.linalg.norm(truth.positions[:, None, :2] - line, axis=-1).min(axis=0)
    assert np.max(distance) < 1e-9
    assert 2 <= len(line) <= 4 * TRACK


def test_arrays_come_no_faster_than_asked(seen):
    """Epochs come at 25 Hz, arrays at 5 Hz at most."""
    assert len(seen.arrays) < len(seen.estimates)


def test_onlookers_end_with_0_and_without_a_word_of_error(seen):
    assert seen.codes == {'watch': 0, 'markers': 0}
    for name in ('watch', 'markers'):
        assert 'Traceback' not in seen.outputs[name]


# ---- watch --png


def test_a_map_shows_track_truth_and_nodes(seen):
    assert seen.png.shows_all()


def test_the_map_is_rewritten_while_the_graph_runs(seen):
    assert len(seen.png.look()) >= 3
    assert [path.name for path in seen.png.path.parent.iterdir()] == ['live.png']


# ---- RViz and Foxglove


def test_rviz_topics_are_offered_with_their_type_and_a_quality_that_suits(seen):
    viewers.check_rviz_topics(RVIZ, seen.topics)


def test_viewers_name_the_namespaces_that_are_published(seen):
    moving = {marker.ns for array in seen.arrays for marker in array.markers}
    fixed = {marker.ns for marker in seen.anchors.markers if marker.ns}
    viewers.check_namespaces(RVIZ, FOXGLOVE, fixed, moving)


def test_foxglove_paths_lead_through_messages_of_the_graph(seen):
    viewers.check_foxglove_paths(FOXGLOVE, seen.topics)
