"""What is drawn and what viewers load, without a graph."""

from __future__ import annotations

import numpy as np
import pytest

import live
import viewers
from wsn_tracking import graphs
from wsn_tracking.bags.read import read
from wsn_tracking.nodes import convert, markers
from wsn_tracking.nodes.paths import places_of
from wsn_tracking.trackers.estimate import Estimate, Kind
from wsn_tracking.viewing.scene import Scene


def test_markers_change_nothing_in_the_rest_of_the_graph():
    plain, drawn = (graphs.replay(str(live.A_LOOP), markers=asked) for asked in (False, True))
    assert [p for p in drawn if p.name != 'markers'] == list(plain)
    assert [p.executable for p in drawn if p.name == 'markers'] == ['marker_node']


def test_frames_of_the_nodes_are_where_the_nodes_are():
    table = read(live.A_LOOP).anchors
    frames = markers.node_frames(table, 7)
    assert {frame.header.frame_id for frame in frames} == {convert.FRAME}
    assert [frame.child_frame_id for frame in frames] == [f'node_{node}' for node in table.ids]
    places = [frame.transform.translation for frame in frames]
    np.testing.assert_array_equal([(p.x, p.y, p.z) for p in places], table.positions)
    assert all(frame.transform.rotation.w == 1.0 for frame in frames)


def test_every_target_has_a_path_of_where_it_was_found():
    """A target that is still looked for has none, nor has the part before it was found."""
    scene = Scene(10)
    for target in (1, 2, 3):
        for k in range(4):
            kind = Kind.START if k < target else Kind.LOCAL
            mean = np.array([target, k, 0.0, 0.0])
            scene.add_estimate(f'hybrid_target_{target}', Estimate(k, target, k, 'x', mean, np.eye(4), kind=kind))
    scene.add_truth(7, 5, np.array([1.0, 2.0]))
    told = {topic: list(places) for topic, places in places_of(scene)}
    assert told == {
        'path/hybrid_target_1': [(k, 1.0, float(k)) for k in (1, 2, 3)],
        'path/hybrid_target_2': [(k, 2.0, float(k)) for k in (2, 3)],
        'path/hybrid_target_3': [(3, 3.0, 3.0)],
        'path/truth_target_7': [(5, 1.0, 2.0)],
    }


def test_rviz_file_has_the_parts_that_rviz_reads():
    content, displays = viewers.rviz_displays(viewers.RVIZ / 'random_q.rviz')
    manager = content['Visualization Manager']
    assert manager['Global Options']['Fixed Frame'] == convert.FRAME
    assert {d['Topic']['Value'] for d in displays} == {
        'anchor_markers',
        'markers',
        'odometry/fused_1',
        'truth/target_1',
    }
    named = [*content['Panels'], *manager['Displays'], *manager['Tools'], manager['Views']['Current']]
    for entry in named:
        assert entry['Class'].partition('/')[0] in {'rviz_common', 'rviz_default_plugins'}
    for display in manager['Displays']:
        assert display['Enabled'] is display['Value'] is True


@pytest.mark.parametrize('name', ['wsn_tracking.json', 'consensus.json'])
def test_foxglove_layout_places_every_panel_once(name):
    layout = viewers.layout(viewers.FOXGLOVE / name)
    assert sorted(viewers.placed(layout, layout['layout'])) == sorted(layout['configById'])
    assert {name.partition('!')[0] for name in layout['configById']} == {
        '3D',
        'DiagnosticStatusPanel',
        'DiagnosticSummary',
        'Plot',
        'RawMessages',
        'Tab',
    }
