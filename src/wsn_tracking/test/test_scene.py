"""What is held of a running graph, and the shapes and colours of it."""

import numpy as np
import pytest
from evaluation_cases import noisy_track
from scene_cases import S, filled, report

from wsn_tracking.evaluation.ellipses import CHI2_95, ellipse, known
from wsn_tracking.sensing.values import Reason
from wsn_tracking.viewing.node_states import ARRIVED, LOOKS, LOST, SENT, UNREPORTED, look, rgb
from wsn_tracking.viewing.scene import TRUTHS_PER_EPOCH, Scene, pick

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
