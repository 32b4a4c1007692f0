"""The trolley: lever arms cancel, samples are thinned to the rate, holes are counted."""

from __future__ import annotations

from datetime import datetime, timezone

import numpy as np
import pytest
from hypothesis import given
from import_cases import BREAKS, FEW, epochs_of, folder, imported, real_data, refused, same_in_any_dress, survives

from wsn_tracking.bags.importing.lias import ANCHORS, LEVERS, Sample, nearest, weights
from wsn_tracking.bags.importing.run import import_set
from wsn_tracking.bags.read import read
from wsn_tracking.errors import TrackingError
from wsn_tracking.sensing.values import Modality

CENTRE = np.array([0.4, -0.7, 0.97])
T0 = round(datetime(2022, 8, 15, 9, 37, 27, tzinfo=timezone.utc).timestamp())


def clock(seconds) -> str:
    return f'2022-08-15 9:37:{27 + int(seconds):02d}.{round(seconds % 1 * 1000):03d}'


def ranges(heading=0.3, centre=CENTRE) -> np.ndarray:
    """(8, 3) what the tags of a trolley measure without error."""
    c, s = np.cos(heading), np.sin(heading)
    tags = centre + np.array([(c * x - s * y, s * x + c * y, 0.0) for x, y in LEVERS])
    return np.linalg.norm(np.array(ANCHORS)[:, None] - tags, axis=2)


def line(seconds, values=None, blank=()) -> str:
    cells = [f'{value:.6f}' for value in (ranges() if values is None else values).ravel()]
    return ','.join([clock(seconds), *('' if i in blank else cell for i, cell in enumerate(cells))]) + '\n'


def files(uwb=None, name='mid') -> dict[str, str]:
    truth = ''.join(f'{clock(k / 100)},0.4,-0.7,0.97,0.006,0.9999,0.0116,-0.005\n' for k in range(201))
    return {
        f'UWB_dynamic_exp_{name}.csv': ''.join(line(k / 100) for k in range(201)) if uwb is None else uwb,
        f'motion_capture_dynamic_exp_{name}.csv': 'time,x,y,z,rotation,,,\n' + truth,
    }


@pytest.mark.parametrize('heading', np.linspace(0.0, 6.0, 7))
def test_the_weighted_range_is_that_of_the_centroid_at_every_heading(heading):
    np.testing.assert_allclose(weights().sum(), 1.0)
    np.testing.assert_allclose(weights() @ np.array(LEVERS), 0.0, atol=1e-12)
    exact = np.linalg.norm(np.array(ANCHORS) - CENTRE, axis=1)
    weighted = np.abs(ranges(heading) @ weights() - exact).max()
    assert weighted < 0.012  # of second order: lever^2 / 2 d
    assert weighted < np.abs(ranges(heading).mean(axis=1) - exact).max() / 2.0


def test_an_epoch_is_the_nearest_sample_to_every_period(tmp_path):
    back = imported('lias', files(), tmp_path)
    epochs = epochs_of(back)
    assert [request.stamp_ns for request, _, _ in epochs] == [T0 * 10**9 + k * 10**8 for k in range(21)]
    for _, packets, _ in epochs:
        assert [m.node_id for m in packets] == list(range(8))
        assert all(m.modality == Modality.UWB and np.isnan(m.variance) for m in packets)
        np.testing.assert_allclose([m.range for m in packets], ranges() @ weights(), atol=1e-6)
    assert back.metadata['period'] == '0.1000'
    assert back.metadata['target_height'] == '0.97'
    np.testing.assert_allclose(back.truth[1].positions, np.tile(CENTRE, (back.truth[1].stamps_ns.size, 1)))
    assert np.diff(back.truth[1].stamps_ns).min() == 50_000_000


def test_the_rate_is_a_choice(tmp_path):
    assert len(epochs_of(imported('lias', files(), tmp_path, rate=4.0))) == 9
    assert len(epochs_of(imported('lias', files(), tmp_path, rate=1000.0))) == 201
    with pytest.raises(TrackingError, match=r'0 Hz: 0\.01 to 1000'):
        imported('lias', files(), tmp_path, rate=0.0)
    with pytest.raises(TrackingError, match='a rate is for lias alone'):
        imported('plaza', files(), tmp_path, rate=4.0)


def test_nearest_leaves_a_hole_where_there_is_one():
    samples = [Sample(round(t * 1e9), np.ones((8, 3))) for t in (5.0, 5.04, 5.09, 5.12, 5.4, 5.49)]
    kept = [sample.stamp_ns / 1e9 for sample in nearest(samples, 0.1)]
    assert kept == [5.0, 5.09, 5.4, 5.49]
    assert nearest([], 0.1) == []
    assert nearest(samples[:1], 0.1) == samples[:1]


def test_what_is_missing_or_broken_is_counted_by_reason(tmp_path):
    far = ranges()
    far[0, 0] = 2e4
    zero = ranges()
    zero[1, 1] = 0.0
    uwb = (
        line(0.0, blank=[23])
        + line(0.1, far)
        + line(0.2, zero)
        + 'hello\n'
        + line(0.3).replace('2022', 'year')
        + line(0.4, blank=range(24))
        + line(0.5)
    )
    content = files(uwb)
    content['motion_capture_dynamic_exp_mid.csv'] += 'x\nnow,1,2,3\n' + clock(9) + ',a,1,2\n'
    back = imported('lias', content, tmp_path)
    assert back.metadata['import_dropped'] == (
        'absurd_number 1, absurd_range 1, not_a_time 1, tag_missing 3, '
        'truth_not_a_number 1, truth_not_a_time 1, truth_wrong_columns 1, wrong_columns 1'
    )
    heard = [[m.node_id for m in packets] for _, packets, _ in epochs_of(back)]
    assert heard == [[0, 1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6, 7], [0, 2, 3, 4, 5, 6, 7], [], list(range(8))]


def test_of_several_recordings_one_is_to_be_named(tmp_path):
    both = {**files(), **files(name='fast')}
    refused('lias', both, tmp_path, r'holds 2 of UWB_\*.csv \(UWB_dynamic_exp_fast.csv, UWB_dynamic_exp_mid.csv\)')
    source = folder(tmp_path / 'src', both)
    (bag,) = import_set('lias', source / 'UWB_dynamic_exp_fast.csv', tmp_path / 'fast')
    assert read(bag).metadata['source'].endswith('UWB_dynamic_exp_fast.csv')


def test_what_is_wrong_is_told_in_one_line(tmp_path):
    refused('lias', {'readme.txt': ''}, tmp_path, r'holds no UWB_\*.csv')
    refused('lias', {'UWB_a.csv': line(0.0)}, tmp_path, r'motion_capture_a.csv cannot be read')
    refused('lias', files('hello\n'), tmp_path, r'no measurement can be used \(wrong_columns 1\)')


def test_texts_of_other_systems_hold_the_same(tmp_path):
    same_in_any_dress('lias', files(''.join(line(k / 10) for k in range(3))), tmp_path)


@FEW
@given(breaks=BREAKS)
def test_broken_files_give_a_bag_or_one_line(tmp_path, breaks):
    survives('lias', files(''.join(line(k / 10) for k in range(3))), breaks, tmp_path)


def test_the_real_trolley_has_long_ranges_with_little_noise(tmp_path):
    (bag,) = import_set('lias', real_data('lias_uwb_planar'), tmp_path / 'bag')
    back = read(bag)
    epochs = epochs_of(back)
    assert 1285 <= len(epochs) <= 1292  # 129 s at 10 Hz
    truth = back.truth[1]
    assert np.all((truth.positions[:, 2] > 0.94) & (truth.positions[:, 2] < 1.0))
    stamps = np.array([request.stamp_ns for request, _, _ in epochs])
    off = (stamps - stamps[0] + 50_000_000) % 100_000_000 - 50_000_000
    assert np.median(np.abs(off)) < 4e6  # samples come every 10 ms
    places = np.column_stack([np.interp(stamps, truth.stamps_ns, axis) for axis in truth.positions.T])
    d = np.linalg.norm(places[:, None] - back.anchors.positions, axis=2)
    error = np.full(d.shape, np.nan)
    for k, (_, packets, _) in enumerate(epochs):
        for m in packets:
            error[k, m.node_id] = m.range - d[k, m.node_id]
    bias, std = np.nanmean(error, axis=0), np.nanstd(error, axis=0)
    assert np.all((bias > 0.1) & (bias < 0.3))
    assert np.all((std > 0.03) & (std < 0.06))  # of the average; a single tag has 0.04 to 0.08
