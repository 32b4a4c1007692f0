"""How a scene is drawn while it changes."""

from itertools import pairwise

import numpy as np
import pytest
from scene_cases import S, filled, report

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import plot_style
from wsn_tracking.viewing.live_legend import label
from wsn_tracking.viewing.node_states import rgb
from wsn_tracking.viewing.scene import Scene, Trail


@pytest.fixture
def live():
    pytest.importorskip('matplotlib')
    from wsn_tracking.viewing import live_map, live_track

    figure = live_map.new_live_figure()
    return figure, live_map.LiveMap(figure, 'title'), live_track


def pixels(figure):
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3]


def count(figure, color):
    return int(np.sum(np.all(pixels(figure) == np.round(np.array(rgb(color)) * 255), axis=-1)))


def test_a_map_of_nothing_says_so_and_one_of_something_does_not(live):
    figure, view, _ = live
    view.draw(Scene(5))
    words = {text.get_text(): text for text in figure.texts}
    assert words['no data yet'].get_visible()
    view.draw(filled()[0])
    assert not words['no data yet'].get_visible()
    assert count(figure, plot_style.COLOURS[0]) > 100


def test_a_redraw_makes_no_new_artists(live):
    figure, view, _ = live
    scene, _, estimates = filled()
    view.draw(scene)
    before = len(figure.axes[0].get_children()), len(figure.get_children())
    scene.add_estimate('fused_1', estimates[-1]._replace(stamp_ns=estimates[-1].stamp_ns + S, target_id=1))
    view.draw(scene)
    assert (len(figure.axes[0].get_children()), len(figure.get_children())) == before


def test_a_lost_track_leaves_the_picture_and_does_not_shrink_the_room(live):
    figure, view, _ = live
    scene, _, estimates = filled()
    view.draw(scene)
    before = figure.axes[0].get_xlim()
    scene.add_estimate('fused_1', estimates[-1]._replace(mean=np.full(4, 1e6), target_id=1))
    view.draw(scene)
    assert figure.axes[0].get_xlim() == before
    assert before[0] < 0.0
    assert before[1] > 8.0


def test_an_output_that_is_forgotten_leaves_the_map(live):
    figure, view, _ = live
    scene, _, _ = filled()
    view.draw(scene)
    scene.forget('fused_1')
    view.draw(scene)
    assert count(figure, plot_style.COLOURS[0]) == 0


def test_age_fades_a_line_until_it_is_gone(live):
    _, _, live_track = live
    rows = np.array(live_track.faded('#0072b2', np.arange(0, 11) * S, 10 * S, 10.0 * S))
    np.testing.assert_allclose(rows[-1], (*rgb('#0072b2'), 1.0))
    assert rows[0, 3] == 0.0
    assert np.all(np.diff(rows[1:, 0]) < 0.0)


def test_a_truth_that_was_missed_for_a_while_is_not_drawn_as_a_straight_way(live):
    figure, view, _ = live
    scene, _, _ = filled()
    for second, x in ((100, 0.0), (101, 1.0), (102, 2.0), (130, 3.0), (131, 4.0), (132, 5.0)):
        scene.add_truth(2, second * S, np.array([x, 1.0]))
    view.draw(scene)
    lines = [c.get_segments() for c in figure.axes[0].collections if hasattr(c, 'get_segments')]
    ways = [sorted(piece[:, 0].tolist() for piece in line) for line in lines]
    assert [[0.0, 1.0], [1.0, 2.0], [3.0, 4.0], [4.0, 5.0]] in ways


def test_rings_stay_where_they_are_as_a_track_grows(live):
    _, _, live_track = live
    steps = [live_track.track_step(epochs) for epochs in range(1, 300)]
    assert all(later % step == 0 for step, later in pairwise(steps))
    assert all(epochs / step <= 2 * live_track.PAST_ELLIPSES for epochs, step in enumerate(steps, 1))


def test_the_legend_says_how_far_off_an_output_is_only_where_the_truth_is_known():
    scene, _, _ = filled()
    (track,), (trail,) = scene.tracks, scene.trails
    off = np.hypot(*(track.estimates[-1].mean[:2] - trail.positions[-1]))
    assert label(track, trail, several=False) == f'fused_1   {off:.2f} m off'
    assert label(track, None, several=True) == 'fused_1 of 1'
    late = Trail(1, trail.stamps_ns + 1000 * S, trail.positions)
    assert label(track, late, several=False) == 'fused_1'


def test_several_targets_and_stamps_beyond_the_calendar_are_drawn(live):
    figure, view, _ = live
    scene, _, estimates = filled()
    far = estimates[-1]._replace(target_id=2, stamp_ns=2**61, source='fused_1')
    scene.add_estimate('fused_1', far)
    scene.add_report(report(1, sent=(1, 99)))
    view.draw(scene, 'silent for 9 s')
    told = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert 'fused_1 of 2' in told
    assert '2 sent' in told
    assert 'silent for 9 s' in [text.get_text() for text in figure.texts]


def test_a_png_is_left_alone_while_nothing_has_changed(tmp_path):
    pytest.importorskip('matplotlib')
    from wsn_tracking.viewing.live_window import Png

    path, (scene, _, estimates) = tmp_path / 'live.png', filled()
    view = Png(path, 'title')
    view.show(scene, '')
    path.unlink()
    view.show(scene, '')
    assert not path.exists()
    scene.add_estimate('fused_1', estimates[-1]._replace(target_id=1))
    view.show(scene, '')
    assert path.read_bytes().startswith(b'\x89PNG')


def test_a_png_that_cannot_be_written_is_one_clear_error(tmp_path):
    pytest.importorskip('matplotlib')
    from wsn_tracking.viewing.live_window import Png

    (tmp_path / 'file').write_text('')
    with pytest.raises(TrackingError, match='cannot be written'):
        Png(tmp_path / 'file' / 'live.png', 'title').show(Scene(5), '')
