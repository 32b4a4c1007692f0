import struct
import sys

import numpy as np
import pytest
from evaluation_cases import line_truth, noisy_track, track

from wsn_tracking.errors import TrackingError
from wsn_tracking.evaluation import metrics, plot_map, plot_style
from wsn_tracking.evaluation.consistency import chi_square_quantile
from wsn_tracking.evaluation.plot_series import plot_errors, plot_nees
from wsn_tracking.evaluation.plots import plot_all
from wsn_tracking.models.anchors import make_anchors
from wsn_tracking.trackers.estimate import Kind

AREA = (0.0, 0.0, 8.0, 4.0)


@pytest.fixture(scope='module')
def anchors():
    return make_anchors(range(1, 5), [(0, 0), (8, 0), (8, 4), (0, 4)])


@pytest.fixture
def figures(monkeypatch):
    """The figures that were drawn, instead of files."""
    pytest.importorskip('matplotlib')
    drawn = []

    def keep(figure, _):
        figure.draw_without_rendering()
        drawn.append(figure)

    monkeypatch.setattr(plot_style, 'save', keep)
    return drawn


def outputs(names=('local_1', 'fused_1')):
    return {
        name: noisy_track(i, source=name, kind=Kind.FUSED if 'fused' in name else Kind.LOCAL)[1]
        for i, name in enumerate(names)
    }


def test_a_run_is_drawn_in_three_pngs_of_a_sensible_size(tmp_path, anchors):
    pytest.importorskip('matplotlib')
    truth, _ = noisy_track()
    written = plot_all(tmp_path / 'plots', anchors, {7: truth}, outputs(), AREA, title='a_loop')
    assert [path.name for path in written] == ['map.png', 'error.png', 'nees.png']
    assert sorted(path.name for path in (tmp_path / 'plots').iterdir()) == [
        'error.png',
        'map.png',
        'nees.png',
    ]
    for path in written:
        content = path.read_bytes()
        assert content.startswith(b'\x89PNG')
        assert all(400 < side < 3000 for side in struct.unpack('>II', content[16:24]))
    assert 'matplotlib.pyplot' not in sys.modules


def test_equal_input_gives_equal_bytes(tmp_path, anchors):
    pytest.importorskip('matplotlib')
    for name in ('one.png', 'two.png'):
        plot_map.plot_map(tmp_path / name, anchors, {}, outputs(), AREA)
    assert (tmp_path / 'one.png').read_bytes() == (tmp_path / 'two.png').read_bytes()


def test_without_truth_there_is_only_the_map(figures, anchors, tmp_path):
    assert [path.name for path in plot_all(tmp_path, anchors, {}, outputs())] == ['map.png']
    assert len(figures) == 1


def test_a_border_point_of_the_ellipse_has_the_nees_of_the_95_percent_quantile():
    covariance = np.array([[[0.4, 0.1], [0.1, 0.2]], [[0.01, 0.0], [0.0, 9.0]]])
    mean = np.array([[1.0, 2.0], [3.0, 4.0]])
    border = plot_map.ellipse(mean, covariance)
    values = metrics.nees(border - mean[:, None], covariance[:, None])
    np.testing.assert_allclose(values, chi_square_quantile(0.95, 2.0), rtol=1e-9)


def test_map_has_equal_axes_units_and_a_legend_of_every_output(figures, anchors):
    truth, _ = noisy_track()
    plot_map.plot_map('map.png', anchors, {7: truth}, outputs(), AREA)
    (axes,) = figures[0].axes
    assert axes.get_aspect() == 1.0
    assert (axes.get_xlabel(), axes.get_ylabel()) == ('x [m]', 'y [m]')
    told = [text.get_text() for text in figures[0].legends[0].get_texts()]
    assert told == ['truth', 'start', 'local_1', 'fused_1', '95 % of fused_1', 'node']
    legend = figures[0].legends[0].get_window_extent()
    assert not legend.overlaps(axes.get_window_extent())


def test_of_several_targets_colour_is_time_and_what_is_not_found_yet_is_not_drawn(figures, anchors):
    """The same colour, the same instant, whoever it was; a second output of a target has a colour of its own."""
    truth, estimates = noisy_track()
    tracks = {}
    for target, late in ((1, 0), (2, 20)):
        kinds = [Kind.START] * late + [Kind.LOCAL] * (len(estimates) - late)
        tracks[f'hybrid_target_{target}'] = [
            e._replace(target_id=target, kind=k) for e, k in zip(estimates, kinds, strict=True)
        ]
    tracks['other'] = [e._replace(target_id=2) for e in estimates]
    truths = {target: truth._replace(target_id=target) for target in (1, 2)}
    plot_map.plot_map('map.png', anchors, truths, tracks, AREA)
    axes, bar = figures[0].axes
    assert bar.get_ylabel() == 'time [s]'
    (timed,) = axes.collections
    first = min(e.stamp_ns for e in estimates)
    seconds = [(e.stamp_ns - first) * 1e-9 for e in estimates[1:]]
    np.testing.assert_allclose(timed.get_array(), [*seconds, *seconds])
    ends = np.array([segment[-1] for segment in timed.get_segments() if len(segment) == 2])
    np.testing.assert_allclose(ends[: len(seconds)], [e.mean[:2] for e in estimates[1:]])
    assert len(ends) == 2 * len(seconds) - 20
    told = [text.get_text() for text in figures[0].legends[0].get_texts()]
    assert told[:5] == ['truth', 'start', 'hybrid_target_1, at the end', 'hybrid_target_2, at the end', 'other']


def test_map_keeps_the_room_in_view_when_a_track_is_lost(figures, anchors):
    truth = line_truth(10, speed=(0.1, 0.1))
    lost = track(truth, np.full((10, 2), 1e4), np.eye(2))
    plot_map.plot_map('map.png', anchors, {7: truth}, {'lost': lost}, AREA)
    assert figures[0].axes[0].get_xlim()[1] < 20.0


def test_ellipses_can_be_asked_of_any_output_and_default_to_a_known_one(figures, anchors):
    truth = line_truth()
    unsure = track(truth, np.zeros((30, 2)))
    plot_map.plot_map('map.png', anchors, {7: truth}, {'mean': unsure, **outputs(['local_1'])}, ellipses_of=None)
    plot_map.plot_map('map.png', anchors, {7: truth}, outputs(), ellipses_of='local_1')
    plot_map.plot_map('map.png', anchors, {7: truth}, {'mean': unsure})
    told = [[text.get_text() for text in f.legends[0].get_texts() if '95' in text.get_text()] for f in figures]
    assert told == [['95 % of local_1'], ['95 % of local_1'], []]
    with pytest.raises(TrackingError, match=r'no output fused_9: .* local_1, fused_1'):
        plot_map.plot_map('map.png', anchors, {7: truth}, outputs(), ellipses_of='fused_9')


def test_many_nodes_are_drawn_without_their_numbers(figures):
    grid = [(x, y) for x in range(10) for y in range(10)]
    plot_map.plot_map('map.png', make_anchors(range(100), grid), {}, outputs())
    assert len(figures[0].axes[0].texts) == 0
    plot_map.plot_map('map.png', make_anchors(range(50), grid[:50]), {}, outputs())
    assert len(figures[1].axes[0].texts) == 50


def test_error_figure_has_a_panel_an_axis_and_output_with_its_band(figures):
    truth, _ = noisy_track()
    tracks = {**outputs(), 'mean': track(truth, np.zeros((60, 2)))}
    plot_errors('error.png', {7: truth}, tracks)
    axes = figures[0].axes
    assert len(axes) == 6
    assert axes[0].get_ylabel() == 'error [m]'
    assert axes[-1].get_xlabel() == 'time since the start [s]'
    band = axes[0].collections[0].get_paths()[0].vertices[:, 1]
    assert np.max(band) == pytest.approx(3.0 * np.sqrt(0.04))
    assert axes[4].get_title(loc='left') == 'mean (no covariance)'


def test_nees_figure_tells_the_mean_and_marks_what_is_beyond_the_axis(figures):
    truth, estimates = noisy_track()
    liar = [e._replace(covariance=e.covariance / 50.0) for e in estimates]
    silent = track(truth, np.zeros((60, 2)))
    plot_nees('nees.png', {7: truth}, {'good': estimates, 'liar': liar, 'mean': silent})
    good, bad = (axes.get_title(loc='left') for axes in figures[0].axes)
    assert ' in [' in good
    assert ' outside [' in bad
    assert 'without covariance: mean' in figures[0].get_suptitle()
    marks = [line for line in figures[0].axes[1].lines if line.get_marker() == '^']
    assert len(marks[0].get_xdata()) > 30


@pytest.mark.parametrize('tracks', [{}, {'mean': None}, {'human': []}])
def test_nothing_to_draw_is_an_empty_figure_and_no_error(figures, tracks, anchors, tmp_path):
    truth = line_truth()
    known = {name: track(truth, np.zeros((30, 2))) if value is None else value for name, value in tracks.items()}
    plot_all(tmp_path, anchors, {7: truth}, known)
    assert len(figures) == 3


def test_a_run_that_is_all_skipped_is_still_drawn(figures):
    truth, estimates = noisy_track()
    plot_nees('nees.png', {7: truth}, {'human': estimates}, skip_s=1e6)
    plot_errors('error.png', {7: truth}, {'human': estimates}, skip_s=0.0)
    told = [text.get_text() for text in figures[1].legends[0].get_texts()]
    assert len(figures) == 2
    assert 'not scored' not in told


def test_more_outputs_than_a_figure_holds_are_cut_and_said(figures):
    truth, estimates = noisy_track(epochs=8)
    many = {f'consensus_{i}': estimates for i in range(50)}
    plot_errors('error.png', {7: truth}, many)
    assert len(figures[0].axes) == 2 * plot_style.MOST
    assert 'first 12 of 50 outputs' in figures[0].get_suptitle()


def test_every_output_has_its_own_pen():
    pens = plot_style.pens(f'consensus_{i}' for i in range(plot_style.MOST))
    assert len(set(pens.values())) == plot_style.MOST


def test_a_missing_matplotlib_is_one_clear_error(monkeypatch, anchors, tmp_path):
    monkeypatch.setitem(sys.modules, 'matplotlib.figure', None)
    with pytest.raises(TrackingError, match='install matplotlib'):
        plot_all(tmp_path, anchors, {}, outputs())
