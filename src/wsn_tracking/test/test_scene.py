"""What is held of a running graph, and how it is drawn."""

from itertools import pairwise

import numpy as np
import pytest
from evaluation_cases import noisy_track

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import plot_style
from wsn_tracking.evaluation.ellipses import CHI2_95, ellipse, known
from wsn_tracking.evaluation.live_legend import label
from wsn_tracking.evaluation.node_states import ARRIVED, LOOKS, LOST, SENT, UNREPORTED, look, rgb
from wsn_tracking.evaluation.scene import TRUTHS_PER_EPOCH, Scene, Trail, pick
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.sensing.values import Reason, TriggerReport

S = 1_000_000_000


def report(seq, sent=(), silent=(), reasons=(), target=1):
    return TriggerReport(seq * S, target, seq, sent, tuple(range(len(sent))), silent, reasons)


def filled(epochs=60, length=20):
    truth, estimates = noisy_track(epochs=epochs)
    scene = Scene(length)
    scene.add_anchors(make_anchors(range(1, 5), [(0, 0), (8, 0), (8, 4), (0, 4)]))
    for stamp, position in zip(truth.stamps_ns.tolist(), truth.positions, strict=True):
        scene.add_truth(1, stamp, position)
    for estimate in estimates:
        scene.add_estimate('fused_1', estimate._replace(target_id=1))
    return scene, truth, estimates


# ---- geometry and colours


@pytest.mark.parametrize('seed', range(5))
def test_every_point_of_an_ellipse_satisfies_the_mahalanobis_equation(seed):
    generator = np.random.default_rng(seed)
    root = generator.normal(size=(3, 2, 2)) * generator.uniform(0.01, 10.0, (3, 1, 1))
    mean, P = generator.normal(size=(3, 2)), root @ np.swapaxes(root, -1, -2)
    offset = ellipse(mean, P) - mean[:, None]
    squared = np.einsum('...pi,...ij,...pj->...p', offset, np.linalg.inv(P), offset)
    np.testing.assert_allclose(squared, CHI2_95, rtol=1e-8)
    np.testing.assert_allclose(offset[:, 0], offset[:, -1], atol=1e-9)


def test_an_estimate_without_a_definite_covariance_has_no_ellipse():
    _, estimates = noisy_track(epochs=4)
    bad = [np.full((4, 4), np.nan), np.zeros((4, 4)), -np.eye(4)]
    unsure = [e._replace(covariance=P) for e, P in zip(estimates, bad, strict=False)]
    assert len(known(unsure)[0]) == 0
    assert len(known(estimates)[0]) == 4


def test_every_reason_and_sent_has_a_colour_and_words_of_its_own():
    assert set(LOOKS) == {SENT, ARRIVED, LOST, *Reason}
    looks = [*LOOKS.values(), UNREPORTED]
    assert len({one.color for one in looks}) == len({one.words for one in looks}) == len(Reason) + 4
    assert all(0.0 <= part <= 1.0 for one in looks for part in rgb(one.color))
    assert look(200).words == 'reason 200'


def test_colours_are_read_as_red_green_blue():
    assert rgb('#ff0080') == (1.0, 0.0, pytest.approx(128 / 255))


# ---- what is held


def test_a_scene_holds_no_more_than_its_length():
    scene, _, estimates = filled(epochs=60, length=20)
    (track,) = scene.tracks
    assert [e.request_seq for e in track.estimates] == [e.request_seq for e in estimates[-20:]]
    assert len(scene.trails[0].positions) <= TRUTHS_PER_EPOCH * 20


def test_a_truth_of_100_hz_is_thinned_and_covers_the_whole_window():
    scene = Scene(20)
    _, estimates = noisy_track(epochs=40)
    start = estimates[0].stamp_ns
    for estimate in estimates:
        for stamp in range(estimate.stamp_ns - S + S // 100, estimate.stamp_ns + 1, S // 100):
            scene.add_truth(1, stamp, np.array([(stamp - start) * 1e-9, 0.0, 0.0]))
        scene.add_estimate('fused_1', estimate)
    (trail,) = scene.trails
    assert trail.stamps_ns[-1] == estimates[-1].stamp_ns
    assert trail.stamps_ns[0] <= scene.tracks[0].estimates[0].stamp_ns
    assert len(trail.stamps_ns) <= TRUTHS_PER_EPOCH * 20


def test_stamps_that_fall_back_begin_anew():
    scene, truth, estimates = filled()
    scene.add_estimate('fused_1', estimates[0]._replace(target_id=1))
    scene.add_truth(1, int(truth.stamps_ns[0]), truth.positions[0])
    assert [len(scene.tracks[0].estimates), len(scene.trails[0].positions)] == [1, 1]


def test_what_has_no_position_is_not_held():
    scene = Scene(5)
    _, estimates = noisy_track(epochs=2)
    scene.add_estimate('a', estimates[0]._replace(mean=np.full(4, np.nan)))
    scene.add_estimate('a', estimates[0]._replace(mean=np.zeros(1)))
    scene.add_truth(1, 0, np.full(3, np.nan))
    assert (scene.tracks, scene.trails, scene.version, scene.newest) == ((), (), 0, None)


def test_reports_of_several_sensing_processes_are_one_epoch():
    scene = Scene(5)
    scene.add_report(report(7, sent=(1,)))
    scene.add_report(report(7, silent=(2,), reasons=(Reason.NOISY,)))
    assert scene.node_states == {1: SENT, 2: Reason.NOISY}


def test_a_node_that_told_nothing_for_two_epochs_has_no_state():
    scene = Scene(5)
    scene.add_report(report(1, sent=(1, 2)))
    scene.add_report(report(2, sent=(1,)))
    assert set(scene.node_states) == {1, 2}
    scene.add_report(report(3, sent=(1,)))
    assert set(scene.node_states) == {1}


def test_a_node_that_sent_to_any_target_is_shown_as_sent():
    scene = Scene(5)
    scene.add_report(report(1, sent=(4,), target=1))
    scene.add_report(report(1, silent=(4,), reasons=(Reason.NOT_HEARD,), target=2))
    assert scene.node_states == {4: SENT}


def test_reports_of_a_new_run_replace_those_of_the_old_one():
    scene = Scene(5)
    scene.add_report(report(50, sent=(1, 2)))
    scene.add_report(report(0, silent=(1,), reasons=(Reason.UNCHANGED,)))
    assert scene.node_states == {1: Reason.UNCHANGED}


def test_one_output_of_each_kind_and_target_is_picked():
    assert pick(['local_1', 'local_2']) == ('local_1',)
    assert pick(['local_1', 'fused_2', 'fused_10', 'mean', 'human_lag', 'human']) == (
        'fused_2',
        'human',
        'human_lag',
        'mean',
    )
    assert pick(['hybrid_target_1', 'hybrid_target_2', 'consensus_9', 'consensus_11']) == (
        'consensus_9',
        'hybrid_target_1',
        'hybrid_target_2',
    )
    assert pick(['consensus_3_target_2', 'consensus_1_target_2']) == ('consensus_1_target_2',)


# ---- how it is drawn


@pytest.fixture
def live():
    pytest.importorskip('matplotlib')
    from wsn_tracking.evaluation import live_map, live_track

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
    from wsn_tracking.evaluation.live_window import Png

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
    from wsn_tracking.evaluation.live_window import Png

    (tmp_path / 'file').write_text('')
    with pytest.raises(TrackingError, match='cannot be written'):
        Png(tmp_path / 'file' / 'live.png', 'title').show(Scene(5), '')
